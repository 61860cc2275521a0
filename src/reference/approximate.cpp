#include "reference/approximate.h"

#include <algorithm>
#include <cmath>

namespace binosplat::reference {

namespace {

/// The largest |d|^2 of the rays of the tile that contains pixel (x, y).
double farthest_in_tile(const Cone& cone, int x, int y) {
  const int left = x / TILE_SIZE * TILE_SIZE, top = y / TILE_SIZE * TILE_SIZE;
  double farthest = 0.0;
  for (const int px : {left, left + TILE_SIZE - 1}) {
    for (const int py : {top, top + TILE_SIZE - 1}) {
      const glm::dvec3 p(px, py, 1);
      farthest = std::max(farthest, glm::dot(p, cone.ray * p));
    }
  }
  return farthest;
}

}  // namespace

Approximation approximation_of(int tiles, Threshold threshold, double tolerance) {
  if (threshold != Threshold::squared || tiles != TILES_ELLIPSE) return {};
  return {true, std::min(DARK_TRANSMITTANCE_MAX, DARK_TRANSMITTANCE * std::sqrt(tolerance))};
}

bool reaches_block(const Splat& splat, int x, int y) {
  double rho = 1.001 * std::max(0.0, 2.0 * std::log(splat.opacity / splat.threshold)) + 1e-3;
  glm::dvec3 conic = splat.conic;
  if (splat.cone) {
    const glm::dmat3& form = splat.cone->form;
    conic = {form[0][0], form[0][1], form[1][1]};
    rho *= farthest_in_tile(*splat.cone, x, y);
  }
  const glm::dvec2 first =
      glm::ivec2(x, y) / APPROXIMATE_BLOCK * APPROXIMATE_BLOCK;  // the block's first pixel
  const double det = conic.x * conic.z - conic.y * conic.y;
  const double tallest = std::sqrt(rho * conic.x / det);
  const double low = first.y - splat.mean.y, high = low + APPROXIMATE_BLOCK - 1;
  if (low > tallest || high < -tallest) return false;
  // The y of the ellipse's rightmost point, relative to the mean.
  const double apex = -conic.y * std::sqrt(rho / (conic.z * det));
  // The x of the ellipse's leftmost (side -1) or rightmost (side 1) point in the block's rows, relative to
  // the mean.
  const auto edge = [&](double side) {
    const double at = std::clamp(side * apex, low, high);
    const double width = std::sqrt(rho / conic.x * std::max(0.0, 1.0 - at * at / (tallest * tallest)));
    return -conic.y / conic.x * at + side * width;
  };
  const double left = edge(-1.0), right = edge(1.0);
  const double slack = 0.01 + 1e-5 * (std::abs(left) + std::abs(right));
  return splat.mean.x + right + slack >= first.x &&
         splat.mean.x + left - slack <= first.x + APPROXIMATE_BLOCK - 1;
}

}  // namespace binosplat::reference
