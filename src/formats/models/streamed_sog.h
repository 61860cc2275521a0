#pragma once
// Streamed SOG: several SOGs, folders or .sog archives, and a lod-meta.json, which assigns the SOGs'
// Gaussians to chunks and levels of detail. Axes: the trainer's (RDF).

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/models/sog_levels.h"
#include "scene/model.h"

namespace binosplat {

bool is_sog_levels(const nlohmann::json& root);

/// Returns the path of a lod-meta.json: `path` itself, or the file in the folder `path`.
std::filesystem::path lod_meta_of(const std::filesystem::path& path);

/// Returns the parsed file; nothing if the file is missing or of another kind.
std::optional<nlohmann::json> read_lod_meta(const std::filesystem::path& lod_meta);

bool is_streamed_sog(const std::filesystem::path& path);

/// Reads one level of detail, 0 being the finest, and the environment, which is part of every level. Without
/// `lod` it reads the finest complete level, and warns if that is not 0. Gaussians are in the order of files,
/// then as in the file. Throws Error as load_sog does, and for a level that does not exist.
Model load_streamed_sog(const std::filesystem::path& lod_meta, const nlohmann::json& root,
                        std::optional<int> lod);

/// Reads the `ranges` of each file (SogLevels::ranges_in_use), and the environment. Sets Model::format.
Model load_ranges(const std::filesystem::path& lod_meta, const SogLevels& levels,
                  const std::vector<SogLevels::FileRanges>& ranges, const std::string& format);

}  // namespace binosplat
