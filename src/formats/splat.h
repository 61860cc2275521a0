#pragma once
// antimatter15's .splat: records of 32 bytes, nothing around them: position and scale (3 floats each), base
// colour and opacity (4 bytes), quaternion w x y z ((b - 128) / 128). No harmonics. Frame: a ply's (RDF).

#include <span>
#include <string>

#include "scene/model.h"

namespace binosplat {

/// Whether bytes that carry no mark of any format are such records: as many bytes as that takes, and nearly
/// all of the first ones with scales and quaternions as Gaussians have them.
bool is_splat(std::span<const std::byte> bytes);

/// Decodes a file's bytes; `source` names it in errors. Throws Error where they are no whole number of
/// records.
Model load_splat(const std::string& source, std::span<const std::byte> bytes);

}  // namespace binosplat
