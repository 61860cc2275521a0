#pragma once
// Niantic's spz, versions 1 to 4: the positions of all Gaussians, then their opacities and so on, in whole
// bytes. Versions 1 to 3 are compressed with gzip or not at all, version 4 with zstd.
//
// Axes: those that an extension in the file names. Files without it have OpenGL's (RUB), as the format
// defines, or a ply's (RDF), by their writer, which leaves traces; then Model::format ends with axes_assumed.

#include <span>
#include <string>
#include <string_view>

#include "scene/model.h"

namespace binosplat {

inline constexpr std::string_view axes_assumed = ", axes assumed";

/// Decodes a file's bytes. Errors name the file `source`. Of harmonics of degree 4, degrees up to 3 are read,
/// and Model::lacks_degree_4 is set. Throws Error for damaged or cut files, for unknown versions, and for
/// headers that promise more bytes than the file can expand to. Unpacks at most the promised size.
Model load_spz(const std::string& source, std::span<const std::byte> bytes);

}  // namespace binosplat
