#pragma once
// PlayCanvas' SOG, versions 1 and 2: a model's numbers as bytes of lossless WebP pictures, and meta.json that
// describes them. These files are in a folder, or in a zip archive (.sog), possibly in a sub-folder of the
// archive. formats/streamed_sog.h reads models of several SOGs. Axes: the trainer's (RDF), as in a ply.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "scene/model.h"

namespace binosplat {

/// The palette of higher harmonics has up to sog_palette_most entries, addressed by 16-bit labels, in rows of
/// sog_palette_columns.
inline constexpr std::size_t sog_palette_columns = 64, sog_palette_most = 65536;

/// Returns whether a JSON file is the meta.json of a SOG.
bool is_sog_meta(const nlohmann::json& root);

/// Read the SOG of a meta.json, whose parsed contents are `root`, or of an archive. Throw Error naming the
/// file, the key or the picture if something is damaged, missing, or larger than the present bytes can hold.
Model load_sog(const std::filesystem::path& meta, const nlohmann::json& root);
Model load_sog(const std::filesystem::path& archive);

}  // namespace binosplat
