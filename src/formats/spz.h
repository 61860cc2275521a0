#pragma once
// Niantic's spz, versions 1 to 4: attribute after attribute in whole bytes, compressed with gzip (1 to 3) or
// zstd (4), or (1 to 3) not at all.
//
// Frame: OpenGL's (RUB) as the format says, unless an extension in the file names another. Some writers store
// a ply's numbers (RDF) and do not say so: Model::format then ends with axes_not_said.

#include <span>
#include <string>
#include <string_view>

#include "scene/model.h"

namespace binosplat {

inline constexpr std::string_view axes_not_said = ", axes not said";

/// Decodes a file's bytes; `source` names it in errors. Of harmonics of degree 4 degree 3 is
/// read, and Model::lacks_degree_4 is set. Throws Error for damaged or cut files, for unknown versions, and
/// for headers that promise more than the bytes can unfold to; nothing is unpacked beyond what the header
/// promises.
Model load_spz(const std::string& source, std::span<const std::byte> bytes);

}  // namespace binosplat
