#pragma once
// PlayCanvas' SOG, versions 1 and 2: the numbers of a model as bytes of lossless WebP pictures, and meta.json
// that says how they are to be read; as a folder, or as a zip archive (.sog). Streamed SOG is several of them
// with lod-meta.json, which says which of their Gaussians make which level of detail. Frame: the trainer's
// (RDF), as a ply file's.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "formats/detail.h"
#include "scene/model.h"

namespace binosplat {

/// Whether a JSON file is the meta.json of a SOG, or a lod-meta.json.
bool is_sog_meta(const nlohmann::json& root);
bool is_sog_levels(const nlohmann::json& root);

/// Reads the SOG of a meta.json (given parsed) or of an archive. Throws Error naming the file, the key or the
/// picture in it, for anything damaged, missing, or larger than the bytes that are there can hold.
Model load_sog(const std::filesystem::path& meta, const nlohmann::json& root);
Model load_sog(const std::filesystem::path& archive);

/// Reads one level of detail of a streamed SOG, 0 being the finest, and the environment, which belongs to
/// every level. Without `lod`: the finest of which all files are there, which is said where it is not 0.
/// With a `budget`, which counts then, each leaf of the tree has a level of its own (formats/detail.h), among
/// those whose files are there. Gaussians come in the order of the files and of the Gaussians in them. Throws
/// Error as above, and for a level that there is not.
Model load_streamed_sog(const std::filesystem::path& lod_meta, const nlohmann::json& root,
                        std::optional<int> lod, const std::optional<DetailBudget>& budget = {});

}  // namespace binosplat
