#pragma once
// antimatter15's .splat: only records of 32 bytes: position and scale (3 floats each), base colour and
// opacity (4 bytes), quaternion w x y z ((b - 128) / 128). No harmonics. Axes: a ply's (RDF).

#include <span>
#include <string>

#include "scene/model.h"

namespace binosplat {

/// Returns whether bytes without a magic number are .splat records: their number is a multiple of 32, and at
/// least three quarters of the first 1,000 records have plausible scales and quaternions.
bool is_splat(std::span<const std::byte> bytes);

/// Decodes a file's bytes. Quaternions of any length are normalised, with a warning if most are not of length
/// 1: converters of point clouds leave such. Throws Error naming `source` if they are not .splat records.
Model load_splat(const std::string& source, std::span<const std::byte> bytes);

}  // namespace binosplat
