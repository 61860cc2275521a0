#pragma once
// mkkellogg's .ksplat, version 0.1, compression levels 0 to 2: sections of records. Above level 0, positions
// are relative to the centres of buckets. Axes: those of the model that was converted, usually a ply's (RDF).

#include <span>
#include <string>

#include "scene/model.h"

namespace binosplat {

/// Returns whether bytes begin with such a header. The header has no magic number, so this checks the values.
bool is_ksplat(std::span<const std::byte> bytes);

/// Decodes a file's bytes. Errors name the file `source`. Throws Error naming the field or section that is
/// damaged or cut short.
Model load_ksplat(const std::string& source, std::span<const std::byte> bytes);

}  // namespace binosplat
