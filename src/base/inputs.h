#pragma once
// The input files of a run. OutputFile refuses to replace them.

#include <filesystem>

namespace binosplat {

/// Protects this file from OutputFile, under any name, while it exists under this one. Ignores a missing
/// file.
void note_input(const std::filesystem::path& path);

/// Throws Error if `path` is a protected file.
void check_no_input(const std::filesystem::path& path);

}  // namespace binosplat
