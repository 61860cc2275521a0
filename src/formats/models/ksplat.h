#pragma once
// mkkellogg's .ksplat, version 0.1, compression levels 0 to 2: sections of records. Above level 0, positions
// are relative to the centres of buckets. Axes: those of the converted model, usually a ply's (RDF).

#include <span>
#include <string>

#include "scene/model.h"

namespace binosplat {

/// Returns whether bytes begin with a plausible header. The format has no magic number.
bool is_ksplat(std::span<const std::byte> bytes);

/// Decodes a file's bytes. Throws Error naming `source` and the field or section that is damaged or cut.
Model load_ksplat(const std::string& source, std::span<const std::byte> bytes);

}  // namespace binosplat
