#pragma once
// Lists the files of a model.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace binosplat {

/// Returns the files that load_model reads for a model, sorted by name, each once: the model's file
/// (file_of), the existing files to which that file refers, and the file of the training run. A streamed SOG
/// refers to the files of all levels. If the files cannot be determined, throws Error as load_model does.
std::vector<std::filesystem::path> files_of_model(const std::filesystem::path& path);

/// Returns the pictures, existing or not, that a SOG's meta.json names. Throws Error for other JSON.
std::vector<std::filesystem::path> pictures_of_sog(const std::filesystem::path& meta,
                                                   const nlohmann::json& json);

}  // namespace binosplat
