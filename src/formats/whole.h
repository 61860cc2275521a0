#pragma once
// Whether files of ours have all of their bytes: a loss of power, or a copy that was ended, leaves empty and
// cut ones.

#include <filesystem>

namespace binosplat {

/// Tells it of PNG by the sums of its chunks up to the last; of OpenEXR in lines, by its blocks; of WebP, by
/// the size in its header; of JSON, by reading it. What is packed in them is not unpacked. False for other
/// files, and where there is none or it cannot be read.
bool is_whole(const std::filesystem::path& file);

/// Whether a SOG has its meta.json and all files that this names, whole.
bool is_whole_sog(const std::filesystem::path& meta);

}  // namespace binosplat
