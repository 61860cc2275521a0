#pragma once
// What lies around the numbers of an spz file: headers, compression, extensions.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace binosplat {

struct SpzContents {
  std::uint32_t version = 0;  // 1 to 4
  std::size_t count = 0;
  int degree = 0;  // 0 to 4
  int fraction_bits = 0;
  bool antialiased = false;
  std::optional<std::string> axes;  // as scene/axes.h has them, where the file says

  /// Positions, opacities, colours, scales, rotations and harmonics, one attribute of all Gaussians after the
  /// other; exactly as long as count, degree and version say.
  std::vector<std::byte> attributes;
};

/// Bytes a Gaussian of each attribute, in their order.
struct SpzSizes {
  std::size_t position, opacity, colour, scale, rotation, harmonics;
  std::size_t sum() const { return position + opacity + colour + scale + rotation + harmonics; }
};
SpzSizes spz_sizes(std::uint32_t version, int degree);

/// The scale of colours in bytes; wider than the base colours' own, so that those beyond 0 to 1 fit.
constexpr double spz_colour_scale = 0.15;

/// The header of versions 1 to 3, with extensions at the end of the file. `fraction_bits` of positions;
/// throws Error for more Gaussians than it can count.
std::vector<std::byte> spz_header(std::uint32_t version, std::size_t count, int degree, int fraction_bits,
                                  bool antialiased);

/// The extension that names the axes of a file, one of the sixteen that have a number.
std::vector<std::byte> spz_axes_extension(std::string_view axes);

/// Checks and unpacks a file. Throws Error (formats/spz.h).
SpzContents unpack_spz(const std::string& source, std::span<const std::byte> bytes);

}  // namespace binosplat
