#pragma once
// Explains why a pixel differs: finds the decisions of the blend that rounding could change, and their
// effects. Two correct blends of different precision differ visibly only where such a decision differs.

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "reference/project.h"

namespace binosplat::reference {

/// A decision of the blend that rounding could change, and its effect on the pixel.
struct NearDecision {
  double distance = std::numeric_limits<double>::infinity();  // relative; infinity: no such decision
  double change = 0.0;         // largest change of a colour channel, over black
  std::uint32_t gaussian = 0;  // the one concerned; of two neighbours the farther one
};

/// The closest decisions of a pixel. For each kind: the one with the largest change among those within the
/// band that fp32 may cross, or else the closest one.
struct PixelTrace {
  NearDecision alpha;         // an alpha against tau
  NearDecision stop;          // T (1 - alpha) against TRANSMITTANCE_MIN
  NearDecision depth;         // relative gap of depth between two visible neighbours
  std::uint64_t walked = 0;   // entries of the list until the pixel ended
  std::uint64_t visible = 0;  // blended entries

  /// The largest change among the decisions within their bands; 0 if there are none.
  double largest_change() const;
  /// One line: the likeliest cause of a difference, and its largest effect.
  std::string explain() const;
};

/// Relative distances within which fp32 and float64 may decide differently.
constexpr double alpha_band = 1e-3;
constexpr double stop_band = 1e-3;
constexpr double depth_band = 1e-6;

/// Traces pixel (x, y) through the list of its tile (TileLists::at_pixel).
PixelTrace trace(const std::vector<Splat>& splats, std::span<const std::uint32_t> list, int x, int y);

}  // namespace binosplat::reference
