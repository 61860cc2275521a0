#pragma once
// The files that a run reads, which none of its outputs may replace.

#include <filesystem>

namespace binosplat {

/// From now on OutputFile refuses this file, under whatever name, as long as it is there under this one. One
/// that there is not is ignored.
void note_input(const std::filesystem::path& path);

/// Throws Error if `path` is a file that was noted.
void check_no_input(const std::filesystem::path& path);

}  // namespace binosplat
