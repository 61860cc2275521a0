#pragma once
// The input files of a run. OutputFile refuses to replace them.

#include <filesystem>
#include <set>

namespace binosplat {

/// Protects the file that `path` names, also from outputs to other paths of it. Ignores a missing file.
void protect_input(const std::filesystem::path& path);

/// The absolute paths of all protected files.
std::set<std::filesystem::path> noted_inputs();

/// Throws Error if `path` is a protected file.
void check_no_input(const std::filesystem::path& path);

}  // namespace binosplat
