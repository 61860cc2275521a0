#pragma once
// Pictures for SOG: tables of bytes, four a texel, compressed without loss as WebP or PNG.

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

namespace binosplat {

/// The format's longest side, texels.
inline constexpr std::size_t max_webp_side = 16383;

using TableSize = glm::vec<2, std::size_t>;  // width and height, texels

/// Returns the size in a file's header. Throws Error naming `source` unless the file is a PNG or a still,
/// lossless WebP picture, by its content: lossy compression changes the values.
TableSize sog_texture_size(const std::string& source, std::span<const std::byte> bytes);

/// Returns all texels row by row from the top left: R, G, B, and A (255 if the file has none), not
/// premultiplied. Throws Error for damaged data. Allocates the size in the header: check sog_texture_size()
/// first.
std::vector<std::uint8_t> sog_texels(const std::string& source, std::span<const std::byte> bytes);

/// Returns the bytes of a lossless picture, with texels as in sog_texels(). Throws Error if memory is
/// short.
std::vector<std::byte> webp_file(std::span<const std::uint8_t> texels, int width, int height);

}  // namespace binosplat
