#pragma once
// PlayCanvas' compressed ply: four words a Gaussian, relative to the bounds of its chunk of 256.
//
// Its first element is `chunk` (bounds of positions, logarithms of scales and, but for old SuperSplat, base
// colours), then `vertex` with packed_position, packed_rotation, packed_scale and packed_color, and perhaps
// `sh` with the higher harmonics, a byte each and channel-major as in a plain ply. Always binary, least byte
// first. Frame: as a plain ply's (RDF). Comments say whether it is anti-aliased, as there.

#include <filesystem>
#include <span>

#include "formats/ply_header.h"
#include "scene/model.h"

namespace binosplat {

/// Gaussians of a chunk, and the properties of its bounds, of which the colours' may be missing.
inline constexpr std::size_t packed_chunk_size = 256;
inline constexpr const char* packed_chunk_fields[] = {
    "min_x",       "min_y",       "min_z",       "max_x",       "max_y",       "max_z",
    "min_scale_x", "min_scale_y", "min_scale_z", "max_scale_x", "max_scale_y", "max_scale_z",
    "min_r",       "min_g",       "min_b",       "max_r",       "max_g",       "max_b"};

/// Whether the header is one of a compressed ply.
bool is_compressed_ply(const PlyHeader& header);

/// Decodes the bytes of a file with such a header. Throws Error naming `path` and the element where something
/// is missing or the file is too short.
Model load_compressed_ply(const std::filesystem::path& path, std::span<const std::byte> bytes,
                          const PlyHeader& header);

}  // namespace binosplat
