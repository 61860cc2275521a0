#pragma once
// WebP as SOG uses it: losslessly compressed tables of bytes, four a texel.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace binosplat {

/// Texels of the longest side that the format has.
inline constexpr std::size_t webp_side_most = 16383;

struct WebpSize {
  int width = 0;  // texels
  int height = 0;
  std::uint64_t texels() const {
    return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  }
};

/// The size that a file's header promises; `source` names it in errors. Throws Error for anything but a
/// still, lossless WebP picture: the values of a lossy one are not those that were written.
WebpSize webp_size(const std::string& source, std::span<const std::byte> bytes);

/// All texels row by row from the top left, four bytes each (R, G, B, and A = 255 where the file has none),
/// never multiplied by alpha. Throws Error where the data is damaged. Check webp_size first: the memory that
/// this needs is the header's promise.
std::vector<std::uint8_t> webp_texels(const std::string& source, std::span<const std::byte> bytes);

/// The file of a picture without losses, texels as webp_texels gives them. Throws Error where memory is
/// short.
std::vector<std::byte> webp_file(std::span<const std::uint8_t> texels, int width, int height);

}  // namespace binosplat
