#pragma once
// WebP for SOG: tables of bytes, four a texel, compressed without loss.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace binosplat {

/// The format's longest side, texels.
inline constexpr std::size_t webp_side_most = 16383;

struct WebpSize {
  int width = 0;  // texels
  int height = 0;
  std::uint64_t texels() const {
    return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  }
};

/// Returns the size in a file's header. Throws Error naming `source` unless the file is a still, lossless
/// WebP picture: lossy compression changes the values.
WebpSize webp_size(const std::string& source, std::span<const std::byte> bytes);

/// Returns all texels row by row from the top left: R, G, B, and A (255 if the file has none), not
/// premultiplied. Throws Error for damaged data. Allocates the size in the header: check webp_size() first.
std::vector<std::uint8_t> webp_texels(const std::string& source, std::span<const std::byte> bytes);

/// Returns the bytes of a lossless picture, with texels as in webp_texels(). Throws Error if memory is short.
std::vector<std::byte> webp_file(std::span<const std::uint8_t> texels, int width, int height);

}  // namespace binosplat
