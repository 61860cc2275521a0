#pragma once
// mkkellogg's .ksplat, version 0.1, compression levels 0 to 2: sections of records. Above level 0, positions
// are relative to the centres of buckets. Frame: its source's, usually a ply's (RDF).

#include <span>
#include <string>

#include "scene/model.h"

namespace binosplat {

/// Returns whether bytes begin with such a header. It has no magic number, so this checks the fields' values.
bool is_ksplat(std::span<const std::byte> bytes);

/// Decodes a file's bytes; `source` names it in errors. Throws Error naming the field or section that is
/// damaged or cut short.
Model load_ksplat(const std::string& source, std::span<const std::byte> bytes);

}  // namespace binosplat
