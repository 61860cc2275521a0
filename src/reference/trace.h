#pragma once
// Why a pixel differs: the decisions of the blend that rounding could turn, and how much each would change.
// Two blends of equal meaning and different precision differ visibly only where one of these went the other
// way.

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "reference/project.h"

namespace binosplat::reference {

/// A yes or no of the blend that rounding could turn, and what that would do to the pixel.
struct NearDecision {
  double distance = std::numeric_limits<double>::infinity();  // relative; infinity: no such decision
  double change = 0.0;         // of the colour channel that changes most if it went the other way, over black
  std::uint32_t gaussian = 0;  // whose decision it is; of two neighbours the farther one
};

/// How close one pixel came to another colour. Of each kind the decision that would change the colour most
/// among those closer than a band that fp32 may cross; the closest one where none is so close.
struct PixelTrace {
  NearDecision alpha;         // an alpha against tau
  NearDecision stop;          // T (1 - alpha) against TRANSMITTANCE_MIN
  NearDecision depth;         // the gap between two neighbours that the pixel sees, relative to their depth
  std::uint64_t walked = 0;   // entries of the list up to where the pixel ended
  std::uint64_t visible = 0;  // of those, blended

  /// What the likeliest of them may change: the largest change among those within their bands; 0 if none is.
  double largest_change() const;
  /// One line for people: which decision is the likeliest reason for a difference, and how large it may be.
  std::string explain() const;
};

/// Relative distances within which fp32 and float64 may decide differently.
constexpr double alpha_band = 1e-3;
constexpr double stop_band = 1e-3;
constexpr double depth_band = 1e-6;

/// Follows pixel (x, y) through the list of its tile (TileLists::at_pixel).
PixelTrace trace(const std::vector<Splat>& splats, std::span<const std::uint32_t> list, int x, int y);

}  // namespace binosplat::reference
