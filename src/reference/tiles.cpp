#include "reference/tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/error.h"

namespace binosplat::reference {

namespace {

/// The tiles in columns [x0, x1) and rows [y0, y1). Empty if x1 <= x0 or y1 <= y0.
struct TileRange {
  int x0, y0, x1, y1;
};

int tiles_along(shared::uint pixels) { return (static_cast<int>(pixels) + TILE_SIZE - 1) / TILE_SIZE; }

/// Truncates a tile's number towards 0, as C's cast to int does, and clamps it to [0, count].
int clamped_tile(double tile, int count) { return static_cast<int>(std::clamp(tile, 0.0, double(count))); }

/// The tiles of 3D-GS's 3-sigma square, with the roundings of 3D-GS: a lower limit for the difference of the
/// eigenvalues, a radius rounded up to integer px, and tile numbers truncated towards 0.
TileRange aabb_tiles(const Splat& splat, int tiles_x, int tiles_y) {
  const double half_trace = 0.5 * (splat.covariance.x + splat.covariance.z);
  const double lambda1 = half_trace + std::sqrt(std::max(0.1, half_trace * half_trace - splat.det));
  const double radius = std::ceil(3.0 * std::sqrt(lambda1));
  const glm::dvec2 low = (splat.mean - radius) / double(TILE_SIZE);
  const glm::dvec2 high = (splat.mean + radius + double(TILE_SIZE - 1)) / double(TILE_SIZE);
  return {clamped_tile(low.x, tiles_x), clamped_tile(low.y, tiles_y), clamped_tile(high.x, tiles_x),
          clamped_tile(high.y, tiles_y)};
}

/// rho: alpha is at least Th in pixels with q <= rho. Negative if the opacity is below Th.
double reach(const Splat& splat) { return 2.0 * std::log(splat.opacity / splat.threshold); }

/// The box of three standard deviations along the ellipse's axes (GSCore): the unit vector of the longer
/// axis, and half the lengths along and across this axis. Unlike 3D-GS, the box uses the exact eigenvalues.
struct OrientedBox {
  glm::dvec2 axis;
  double along, across;
};

OrientedBox oriented_box(const Splat& splat) {
  const glm::dvec3& c = splat.covariance;
  const double half_difference = 0.5 * (c.x - c.z);
  const double spread = std::hypot(half_difference, c.y);
  const double lambda1 = 0.5 * (c.x + c.z) + spread, lambda2 = splat.det / lambda1;
  // The longer axis has half the angle of the vector (half_difference, c.y); arbitrary for a circle.
  const double angle = 0.5 * std::atan2(c.y, half_difference);
  return {{std::cos(angle), std::sin(angle)}, 3.0 * std::sqrt(lambda1), 3.0 * std::sqrt(lambda2)};
}

/// Half the width and height of the upright box around the oriented box.
glm::dvec2 oriented_half_extents(const Splat& splat) {
  const OrientedBox box = oriented_box(splat);
  return glm::abs(box.axis) * box.along + glm::abs(glm::dvec2(box.axis.y, box.axis.x)) * box.across;
}

/// Half the width and height of the ellipse q = rho. Computed from C2, whereas the blend uses Q. The margin
/// covers the rounding of det, by which C2 and Q differ.
glm::dvec2 snug_half_extents(const Splat& splat) {
  const glm::dvec3& c = splat.covariance;
  const double rho = reach(splat) * (1.0 + 1e-14 * c.x * c.z / splat.det) + 1e-14;
  return {std::sqrt(rho * c.x), std::sqrt(rho * c.z)};
}

/// The tiles with a pixel centre in the upright box of half sizes `half` around the mean. A box that lies
/// between neighbouring columns or rows of pixel centres has no tiles, because no pixel's alpha reaches Th.
TileRange tiles_with_centres(const glm::dvec2& mean, const glm::dvec2& half, const shared::View& view) {
  const glm::dvec2 first = glm::max(glm::ceil(mean - half), 0.0);
  const glm::dvec2 last = glm::min(glm::floor(mean + half), glm::dvec2(view.width, view.height) - 1.0);
  if (!(first.x <= last.x && first.y <= last.y)) return {0, 0, 0, 0};
  const glm::ivec2 low = glm::ivec2(first) / TILE_SIZE, high = glm::ivec2(last) / TILE_SIZE;
  return {low.x, low.y, high.x + 1, high.y + 1};
}

/// Whether the oriented box intersects the rectangle [low, high] of pixel centres, relative to the mean.
/// Tests four separating axes: the picture's two axes and the box's two axes.
bool oriented_box_meets(const Splat& splat, const glm::dvec2& low, const glm::dvec2& high) {
  const glm::dvec2 upright = oriented_half_extents(splat);
  if (low.x > upright.x || high.x < -upright.x || low.y > upright.y || high.y < -upright.y) return false;
  const OrientedBox box = oriented_box(splat);
  const glm::dvec2 middle = 0.5 * (low + high), half = 0.5 * (high - low);
  const auto apart = [&](const glm::dvec2& axis, double reach_of_box) {
    return std::abs(glm::dot(axis, middle)) > reach_of_box + glm::dot(glm::abs(axis), half);
  };
  return !apart(box.axis, box.along) && !apart({-box.axis.y, box.axis.x}, box.across);
}

/// Whether the smallest q over the rectangle [low, high] of pixel centres, relative to the mean, is at most
/// rho. If the mean lies outside, the smallest q lies on a side that faces the mean. One or two sides do.
bool ellipse_meets(const Splat& splat, const glm::dvec2& low, const glm::dvec2& high) {
  const glm::dvec3& c = splat.conic;
  const double rho = reach(splat);
  const glm::dvec2 nearest =
      glm::clamp(glm::dvec2(0.0), low, high);  // x is 0 if low.x <= 0 <= high.x; y likewise
  const auto within_reach = [&](double dx, double dy) {
    const double xx = c.x * dx * dx, xy = 2 * c.y * dx * dy, yy = c.z * dy * dy;
    // Without the margin, rounding could drop a tile in which the blend, with other rounding, reaches Th.
    const double margin = 1e-14 * (xx + std::abs(xy) + yy + 1.0);
    return xx + xy + yy - margin <= rho;
  };
  return within_reach(nearest.x, std::clamp(-c.y * nearest.x / c.z, low.y, high.y)) ||
         within_reach(std::clamp(-c.y * nearest.y / c.x, low.x, high.x), nearest.y);
}

/// The level of TILES_AABB and TILES_OBB: q at three standard deviations.
constexpr double three_sigma = 9.0;

double level_of(const Splat& splat, int tiles) {
  return tiles == TILES_AABB || tiles == TILES_OBB ? three_sigma : reach(splat);
}

/// For a narrow cone: returns a splat whose ellipse q = level is the picture's section of the cone q = level.
Splat section_of(const Splat& splat, double level) {
  const glm::dmat3 g = splat.cone->form - level * splat.cone->ray;  // p^T g p < 0 inside the cone q = level
  const glm::dmat2 inverse = glm::inverse(glm::dmat2(g));
  const glm::dvec2 linear(g[2][0], g[2][1]);
  Splat section = splat;
  section.mean = -(inverse * linear);
  const double scale = -(g[2][2] + glm::dot(linear, section.mean)) / level;
  const glm::dmat2 c = inverse * scale;
  section.covariance = {c[0][0], c[0][1], c[1][1]};
  section.det = glm::determinant(inverse) * scale * scale;
  section.conic = glm::dvec3(c[1][1], -c[0][1], c[0][0]) / section.det;
  section.cone.reset();
  // Excludes the half of the double cone that is behind the eye.
  section.drawn = scale > 0.0 && glm::dot(splat.cone->facing, glm::dvec3(section.mean, 1)) > 0.0;
  return section;
}

/// Whether the smallest q on the segment from `from` to `to` is at most `level`. Along the segment, q is a
/// ratio of two quadratic polynomials. Its derivative is zero at the zeros of a third quadratic polynomial.
bool cone_meets(const Splat& splat, const glm::dvec2& from, const glm::dvec2& to, double level) {
  const glm::dvec3 a(from, 1), b(to - from, 0);
  const glm::dmat3 &form = splat.cone->form, &ray = splat.cone->ray;
  const double n0 = glm::dot(a, form * a), n1 = glm::dot(a, form * b), n2 = glm::dot(b, form * b);
  const double w0 = glm::dot(a, ray * a), w1 = glm::dot(a, ray * b), w2 = glm::dot(b, ray * b);
  const double k2 = n2 * w1 - n1 * w2, k1 = n2 * w0 - n0 * w2, k0 = n1 * w0 - n0 * w1;
  const double root = std::sqrt(std::max(0.0, k1 * k1 - 4 * k2 * k0));
  const double half = -0.5 * (k1 + std::copysign(root, k1));
  for (const double u : {0.0, 1.0, half / k2, k0 / half}) {
    // Without the margin, rounding could drop a tile in which the blend, with other rounding, reaches Th.
    if (u >= 0.0 && u <= 1.0 && squared_distance(splat, from + u * (to - from)) <= level + 1e-8) return true;
  }
  return false;
}

/// Whether q is at most `level` anywhere in a rectangle. The smallest q is at the mean or on a side.
bool cone_meets_rectangle(const Splat& splat, const glm::dvec2& low, const glm::dvec2& high, double level) {
  if (!splat.cone->is_behind && glm::all(glm::lessThanEqual(low, splat.mean)) &&
      glm::all(glm::lessThanEqual(splat.mean, high)))
    return true;
  const glm::dvec2 right(high.x, low.y), left(low.x, high.y);
  return cone_meets(splat, low, right, level) || cone_meets(splat, right, high, level) ||
         cone_meets(splat, high, left, level) || cone_meets(splat, left, low, level);
}

/// The range of x, slightly too large, in which a wide splat is visible in the rows from y = `low` to `high`,
/// in pixel coordinates (docs/method.md 4). If the splat is invisible, the range's begin exceeds its end.
glm::dvec2 wide_across(const Splat& splat, double low, double high, const shared::View& view) {
  const Cone& cone = *splat.cone;
  // q |d|^2 is the sum of the squares of two linear functions of the pixel; the second does not depend on x.
  const glm::dvec3 first = cone.form[0] / std::sqrt(cone.form[0][0]);
  const double down = std::sqrt(std::max(0.0, cone.form[1][1] - first.y * first.y));
  const double level = 2.0 * std::log(splat.opacity / ALPHA_MIN);
  const double y = 0.5 * (low + high), size = 0.5 * (high - low);
  const double rest = (cone.form[1][2] - first.y * first.z) / down;
  const double second = std::max(0.0, std::abs(down * y + rest) - down * size);
  const double middle = -(first.y * y + first.z) / first.x;
  glm::dvec2 seen(-0.5, view.width - 0.5);
  for (int n = 0; n < 3; ++n) {
    double farthest = 0.0;
    for (const double px : {seen.x, seen.y}) {
      for (const double py : {low, high})
        farthest = std::max(farthest, glm::dot(glm::dvec3(px, py, 1), cone.ray * glm::dvec3(px, py, 1)));
    }
    const double radicand = level * farthest - second * second;
    if (radicand < 0.0) return {1.0, 0.0};
    const double reach = (std::sqrt(radicand) + std::abs(first.y) * size) / first.x;
    seen = {std::max(seen.x, middle - reach), std::min(seen.y, middle + reach)};
    if (seen.x > seen.y) return seen;
  }
  const double ahead = cone.facing.y * y + std::abs(cone.facing.y) * size + cone.facing.z;
  const double end = -ahead / cone.facing.x;
  if (cone.facing.x > 0.0) seen.x = std::max(seen.x, end);
  if (cone.facing.x < 0.0) seen.y = std::min(seen.y, end);
  return cone.facing.x == 0.0 && ahead <= 0.0 ? glm::dvec2(1.0, 0.0) : seen;
}

/// The tiles on which shape_meets() then decides.
TileRange candidate_tiles(const Splat& splat, int tiles, const shared::View& view) {
  if (splat.cone && splat.drawn && tiles != TILES_ALL) {
    if (tiles != TILES_AABB && !(splat.opacity >= splat.threshold)) return {0, 0, 0, 0};
    if (is_wide(*splat.cone)) return {0, 0, tiles_along(view.width), tiles_along(view.height)};
    return candidate_tiles(section_of(splat, level_of(splat, tiles)), tiles, view);
  }
  const int tiles_x = tiles_along(view.width), tiles_y = tiles_along(view.height);
  if (!splat.drawn) return {0, 0, 0, 0};
  switch (tiles) {
    case TILES_AABB:
      return aabb_tiles(splat, tiles_x, tiles_y);
    case TILES_OBB:  // one pixel larger: the box may touch a tile's rectangle between pixel centres
      if (!(splat.opacity >= splat.threshold)) return {0, 0, 0, 0};
      return tiles_with_centres(splat.mean, oriented_half_extents(splat) + 1.0, view);
    case TILES_SNUG:
    case TILES_ELLIPSE:
      if (!(splat.opacity >= splat.threshold)) return {0, 0, 0, 0};
      return tiles_with_centres(splat.mean, snug_half_extents(splat), view);
    case TILES_ALL:
      return {0, 0, tiles_x, tiles_y};
  }
  fail("tile test {}: expected one of shared/choices.h", tiles);
}

/// Whether the shape of the tile test `tiles` intersects tile (tx, ty), one of candidate_tiles().
bool shape_meets(const Splat& splat, int tiles, int tx, int ty, const shared::View& view) {
  const glm::dvec2 first(tx * TILE_SIZE, ty * TILE_SIZE);
  const glm::dvec2 last = glm::min(first + double(TILE_SIZE), glm::dvec2(view.width, view.height)) - 1.0;
  if (splat.cone && tiles != TILES_ALL) {
    if (is_wide(*splat.cone)) {
      const glm::dvec2 seen = wide_across(splat, first.y - 0.5, last.y + 0.5, view);
      return seen.x <= seen.y && first.x <= seen.y + 1.0 && last.x >= seen.x - 1.0;
    }
    if (tiles == TILES_ELLIPSE) return cone_meets_rectangle(splat, first, last, level_of(splat, tiles));
    return shape_meets(section_of(splat, level_of(splat, tiles)), tiles, tx, ty, view);
  }
  const glm::dvec2 low = first - splat.mean, high = last - splat.mean;
  if (tiles == TILES_OBB) return oriented_box_meets(splat, low, high);
  if (tiles == TILES_ELLIPSE) return ellipse_meets(splat, low, high);
  return true;  // with other tile tests a splat touches all candidates
}

/// Calls visit(tile number) for every tile of the splat.
template <typename Visit>
void for_each_tile(const Splat& splat, int tiles, const shared::View& view, const Visit& visit) {
  const int tiles_x = tiles_along(view.width);
  const TileRange range = candidate_tiles(splat, tiles, view);
  for (int ty = range.y0; ty < range.y1; ++ty) {
    for (int tx = range.x0; tx < range.x1; ++tx) {
      if (shape_meets(splat, tiles, tx, ty, view)) {
        visit(static_cast<std::size_t>(ty) * tiles_x + tx);
      }
    }
  }
}

}  // namespace

bool is_wide(const Cone& cone) {
  const glm::dmat3& f = cone.form;
  const double fx2 = 1 / cone.ray[0][0], fy2 = 1 / cone.ray[1][1];
  const double xx = f[0][0] * fx2, yy = f[1][1] * fy2, xy2 = f[0][1] * f[0][1] * fx2 * fy2;
  return cone.is_behind || 0.5 * (xx + yy) - std::sqrt(0.25 * (xx - yy) * (xx - yy) + xy2) < WIDE_LEVEL;
}

double squared_distance(const Splat& splat, const glm::dvec2& at) {
  if (splat.cone) {
    const glm::dvec3 p(at, 1);
    if (!(glm::dot(splat.cone->facing, p) > 0.0)) return std::numeric_limits<double>::infinity();
    // At the mean the terms cancel, and rounding may leave less than zero.
    return std::max(0.0, glm::dot(p, splat.cone->form * p) / glm::dot(p, splat.cone->ray * p));
  }
  const glm::dvec2 d = at - splat.mean;
  return splat.conic.x * d.x * d.x + 2 * splat.conic.y * d.x * d.y + splat.conic.z * d.y * d.y;
}

bool touches(const Splat& splat, int tiles, int tx, int ty, const shared::View& view) {
  const TileRange range = candidate_tiles(splat, tiles, view);
  const bool candidate = range.x0 <= tx && tx < range.x1 && range.y0 <= ty && ty < range.y1;
  return candidate && shape_meets(splat, tiles, tx, ty, view);
}

bool touches_any(const Splat& splat, int tiles, const shared::View& view) {
  bool any = false;
  for_each_tile(splat, tiles, view, [&](std::size_t) { any = true; });
  return any;
}

std::vector<std::uint32_t> depth_order(const std::vector<Splat>& splats) {
  std::vector<std::uint32_t> order;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    if (splats[i].drawn) order.push_back(static_cast<std::uint32_t>(i));
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return splats[a].order < splats[b].order; });
  return order;
}

TileLists make_lists(const std::vector<Splat>& splats, const std::vector<std::uint32_t>& order,
                     const shared::View& view, int tiles) {
  TileLists lists;
  lists.tiles_x = static_cast<std::uint32_t>(tiles_along(view.width));
  lists.tiles_y = static_cast<std::uint32_t>(tiles_along(view.height));

  // Counts each tile's splats, sums the counts to find each list's begin, fills the lists in sort order.
  lists.begin.assign(std::size_t{lists.tiles_x} * lists.tiles_y + 1, 0);
  for (const std::uint32_t i : order) {
    for_each_tile(splats[i], tiles, view, [&](std::size_t tile) { ++lists.begin[tile + 1]; });
  }
  std::partial_sum(lists.begin.begin(), lists.begin.end(), lists.begin.begin());
  lists.gaussians.resize(lists.begin.back());
  std::vector<std::uint32_t> next(lists.begin.begin(), lists.begin.end() - 1);
  for (const std::uint32_t i : order) {
    for_each_tile(splats[i], tiles, view, [&](std::size_t tile) { lists.gaussians[next[tile]++] = i; });
  }
  return lists;
}

std::span<const std::uint32_t> TileLists::tile(std::uint32_t tx, std::uint32_t ty) const {
  const std::size_t t = std::size_t{ty} * tiles_x + tx;
  return std::span(gaussians).subspan(begin[t], begin[t + 1] - begin[t]);
}

std::span<const std::uint32_t> TileLists::at_pixel(int x, int y) const {
  return tile(static_cast<std::uint32_t>(x / TILE_SIZE), static_cast<std::uint32_t>(y / TILE_SIZE));
}

}  // namespace binosplat::reference
