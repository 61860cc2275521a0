#pragma once
// PlayCanvas' compressed ply: four 32-bit words a Gaussian, quantised between the bounds of 256 Gaussians.
//
// The binary, little-endian file begins with `chunk`: bounds of positions, of logarithms of scales and
// (except in old SuperSplat files) of base colours. `vertex` follows with packed_position, packed_rotation,
// packed_scale and packed_color. An optional `sh` has the higher harmonics, a byte each, channel-major. Their
// order, the axes (RDF) and comments about anti-aliasing and discs are as in a plain ply
// (formats/models/ply.h).

#include <filesystem>
#include <span>

#include "formats/models/ply_header.h"
#include "scene/model.h"

namespace binosplat {

/// Number of Gaussians in a chunk, and the names of its bounds. Bounds of colours are optional.
inline constexpr std::size_t packed_chunk_size = 256;
inline constexpr const char* packed_chunk_fields[] = {
    "min_x",       "min_y",       "min_z",       "max_x",       "max_y",       "max_z",
    "min_scale_x", "min_scale_y", "min_scale_z", "max_scale_x", "max_scale_y", "max_scale_z",
    "min_r",       "min_g",       "min_b",       "max_r",       "max_g",       "max_b"};

bool is_compressed_ply(const PlyHeader& header);

/// Decodes a file's bytes. Throws Error naming `path` and the element if something is missing or cut short.
Model load_compressed_ply(const std::filesystem::path& path, std::span<const std::byte> bytes,
                          const PlyHeader& header);

}  // namespace binosplat
