#pragma once
// Which files a model is read from.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace binosplat {

/// The files that load_model reads of a model, in order of their names and each once: the one that is named,
/// or that a folder stands for, and those that this one names or that belong beside it, as far as they are
/// there. Of a streamed SOG those of all levels, of which a run may choose any. Throws Error as load_model
/// does where they cannot be found out.
std::vector<std::filesystem::path> files_of_model(const std::filesystem::path& path);

/// The pictures that a SOG's meta.json names, below its folder, whether they are there or not. Throws Error
/// for what is no such file.
std::vector<std::filesystem::path> pictures_of_sog(const std::filesystem::path& meta,
                                                   const nlohmann::json& json);

}  // namespace binosplat
