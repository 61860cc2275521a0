#pragma once
// Explains why a pixel differs between two renderers: finds the blend's decisions that rounding could change,
// and their effects. Correct blends of different precision differ visibly only by such decisions.

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "reference/project.h"

namespace binosplat::reference {

/// A decision of the blend that rounding could change, and its effect on the pixel.
struct NearDecision {
  double distance = std::numeric_limits<double>::infinity();  // relative; infinity: no decision
  double change = 0.0;         // the largest change of a colour channel over black, if decided differently
  std::uint32_t gaussian = 0;  // the Gaussian decided about; of two neighbours the farther one
};

/// A pixel's most important decision of each kind. Of the decisions within the band (below), in which fp32
/// may decide differently, it has the largest change; if the band has none, it is the closest decision.
struct PixelTrace {
  NearDecision alpha;         // whether an alpha reaches tau
  NearDecision stop;          // whether T (1 - alpha) reaches TRANSMITTANCE_MIN
  NearDecision depth;         // which of two visible neighbours is nearer; `distance`: relative gap of depths
  std::uint64_t walked = 0;   // entries of the list until the pixel ended
  std::uint64_t visible = 0;  // blended entries

  /// The largest change among the decisions that lie within their bands; 0 without such decisions.
  double largest_change() const;
  /// Returns the likeliest cause of a difference and its largest effect, in one line.
  std::string explain() const;
};

/// Relative distances within which fp32 and float64 may decide differently.
constexpr double alpha_band = 1e-3;
constexpr double stop_band = 1e-3;
constexpr double depth_band = 1e-6;

/// Traces pixel (x, y) through the list of its tile (TileLists::at_pixel).
PixelTrace trace(const std::vector<Splat>& splats, std::span<const std::uint32_t> list, int x, int y);

}  // namespace binosplat::reference
