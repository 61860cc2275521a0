#pragma once
// Checks that files of binosplat are complete. Power losses and aborted copies leave empty or cut files.

#include <filesystem>

namespace binosplat {

/// Returns whether a file is complete: a PNG by its chunks' checksums, an OpenEXR in scan lines by its
/// blocks, a WebP by the size in its header, JSON by parsing it. Does not unpack pixels. Returns false for
/// other, missing and unreadable files.
bool is_complete(const std::filesystem::path& path);

/// Returns whether a SOG's meta.json and all files that it names are complete.
bool is_whole_sog(const std::filesystem::path& meta);

}  // namespace binosplat
