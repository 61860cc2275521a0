#pragma once
// Streamed SOG: several SOGs, folders or .sog archives, and a lod-meta.json, which says which of their
// Gaussians are which part of the model at which level of detail. Frame: the trainer's (RDF).

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/sog_levels.h"
#include "scene/model.h"

namespace binosplat {

/// Whether a JSON file is a lod-meta.json.
bool is_sog_levels(const nlohmann::json& root);

/// The lod-meta.json that a path names, or that is in the folder of that name.
std::filesystem::path lod_meta_of(const std::filesystem::path& path);

/// What such a file says; none if it is another one, or not there.
std::optional<nlohmann::json> read_lod_meta(const std::filesystem::path& lod_meta);

/// Whether a path names a lod-meta.json, or the folder of one.
bool is_streamed_sog(const std::filesystem::path& path);

/// Reads one level of detail, 0 being the finest, and the environment, which belongs to every level. Without
/// `lod`: the finest of which all files are there, which is said where it is not 0. Gaussians come in the
/// order of the files and of the Gaussians in them. Throws Error as load_sog does, and for a level that there
/// is not.
Model load_streamed_sog(const std::filesystem::path& lod_meta, const nlohmann::json& root,
                        std::optional<int> lod);

/// The same of what is `taken` of each file (SogLevels::taken), and the environment; `format` is the model's.
Model load_taken(const std::filesystem::path& lod_meta, const SogLevels& levels,
                 const std::vector<SogLevels::TakenOfFile>& taken, const std::string& format);

}  // namespace binosplat
