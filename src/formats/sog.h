#pragma once
// PlayCanvas' SOG, versions 1 and 2: the numbers of a model as bytes of lossless WebP pictures, and meta.json
// that says how they are to be read; as a folder, or as a zip archive (.sog), where they may lie in a
// sub-folder; formats/streamed_sog.h is for several of them. Frame: the trainer's (RDF), as a ply file's.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "scene/model.h"

namespace binosplat {

/// The palette of higher harmonics has up to sog_palette_most entries, which labels of 16 bits name, in rows
/// of sog_palette_columns.
inline constexpr std::size_t sog_palette_columns = 64, sog_palette_most = 65536;

/// Whether a JSON file is the meta.json of a SOG.
bool is_sog_meta(const nlohmann::json& root);

/// Reads the SOG of a meta.json (given parsed) or of an archive. Throws Error naming the file, the key or the
/// picture in it, for anything damaged, missing, or larger than the bytes that are there can hold.
Model load_sog(const std::filesystem::path& meta, const nlohmann::json& root);
Model load_sog(const std::filesystem::path& archive);

}  // namespace binosplat
