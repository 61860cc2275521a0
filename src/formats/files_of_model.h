#pragma once
// Lists the files of a model.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace binosplat {

/// Returns the files that load_model reads for a model, sorted by name, each once. They are the named file
/// (or the one found in a folder), existing files that it refers to, and the file of its training run. For a
/// streamed SOG these are the files of all levels. Throws Error as load_model does if they cannot be
/// determined.
std::vector<std::filesystem::path> files_of_model(const std::filesystem::path& path);

/// Returns the pictures that a SOG's meta.json names below its folder, existing or not. Throws Error if the
/// JSON is no such file.
std::vector<std::filesystem::path> pictures_of_sog(const std::filesystem::path& meta,
                                                   const nlohmann::json& json);

}  // namespace binosplat
