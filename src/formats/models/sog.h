#pragma once
// PlayCanvas' SOG, versions 1 and 2: a model's numbers as bytes of lossless WebP or PNG pictures, and
// meta.json that describes them, in a folder or anywhere in a zip archive (.sog). Axes: the trainer's (RDF),
// as in a ply.

#include "formats/containers/opened_file.h"
#include "scene/model.h"

namespace binosplat {

/// Higher harmonics: a palette of up to max_sog_palette entries (16-bit labels), sog_palette_columns a row.
inline constexpr std::size_t sog_palette_columns = 64, max_sog_palette = 65536;

bool is_sog_meta(const nlohmann::json& root);

/// Reads the SOG of a meta.json or of an archive. Throws Error naming the file, the key or the picture if
/// something is damaged, missing, or larger than the file's bytes can hold.
Model load_sog(const OpenedFile& file);

}  // namespace binosplat
