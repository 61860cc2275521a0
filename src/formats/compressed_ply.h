#pragma once
// PlayCanvas' compressed ply: four words a Gaussian, quantised to the bounds of its chunk of 256.
//
// The first element is `chunk`: bounds of positions, of logarithms of scales and (except in old SuperSplat
// files) of base colours. `vertex` follows with packed_position, packed_rotation, packed_scale and
// packed_color. An optional `sh` has the higher harmonics, a byte each, channel-major as in a plain ply. The
// file is binary and little-endian. Frame: RDF, as a plain ply; comments for anti-aliasing are the same, too.

#include <filesystem>
#include <span>

#include "formats/ply_header.h"
#include "scene/model.h"

namespace binosplat {

/// Gaussians of a chunk, and the properties of its bounds; those of colours are optional.
inline constexpr std::size_t packed_chunk_size = 256;
inline constexpr const char* packed_chunk_fields[] = {
    "min_x",       "min_y",       "min_z",       "max_x",       "max_y",       "max_z",
    "min_scale_x", "min_scale_y", "min_scale_z", "max_scale_x", "max_scale_y", "max_scale_z",
    "min_r",       "min_g",       "min_b",       "max_r",       "max_g",       "max_b"};

/// Returns whether the header is a compressed ply's.
bool is_compressed_ply(const PlyHeader& header);

/// Decodes the bytes of a file with such a header. Throws Error naming `path` and the element if something is
/// missing or the file is too short.
Model load_compressed_ply(const std::filesystem::path& path, std::span<const std::byte> bytes,
                          const PlyHeader& header);

}  // namespace binosplat
