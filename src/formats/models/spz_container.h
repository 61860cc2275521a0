#pragma once
// The container of an spz file: header, compression, extensions.

#include <array>
#include <cstdint>
#include <numeric>
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
  std::optional<std::string> axes;  // as in scene/axes.h, if the file names them

  /// Positions, opacities, colours, scales, rotations and harmonics, one attribute of all Gaussians after the
  /// other. The length follows from count, degree and version.
  std::vector<std::byte> attributes;
};

/// The attributes in file order, and the bytes of each for one Gaussian.
enum SpzAttribute { spz_positions, spz_opacities, spz_colours, spz_scales, spz_rotations, spz_harmonics };
struct SpzSizes : std::array<std::size_t, 6> {
  std::size_t sum() const { return std::accumulate(begin(), end(), std::size_t{0}); }
};
SpzSizes spz_sizes(std::uint32_t version, int degree);

/// Scale of the bytes of colours. Their range is wider than 0 to 1, so that base colours beyond 0 to 1 fit.
constexpr double spz_colour_scale = 0.15;

/// Returns the header of versions 1 to 3, which announces extensions at the end of the file. `fraction_bits`
/// is the number of fraction bits of positions. Throws Error for more Gaussians than the header can count.
std::vector<std::byte> spz_header(std::uint32_t version, std::size_t count, int degree, int fraction_bits,
                                  bool antialiased);

/// Returns the extension that names a file's axes. The format must have a number for them.
std::vector<std::byte> spz_axes_extension(std::string_view axes);

/// Checks and unpacks a file. Throws Error as in formats/models/spz.h.
SpzContents unpack_spz(const std::string& source, std::span<const std::byte> bytes);

}  // namespace binosplat
