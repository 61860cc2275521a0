#include "stereo/disagreement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"

namespace binosplat::stereo {

namespace {

constexpr double depth_tolerance = 0.01;

void check_pair(const std::array<shared::View, 2>& views, std::span<const Picture> pictures) {
  if (pictures.size() != 2)
    fail("disagreement of {} pictures: expected a left and a right one", pictures.size());
  for (std::size_t k = 0; k < 2; ++k) {
    if (pictures[k].width != static_cast<int>(views[k].width) ||
        pictures[k].height != static_cast<int>(views[k].height)) {
      fail("disagreement: a picture of {} x {} px for a view of {} x {}", pictures[k].width,
           pictures[k].height, views[k].width, views[k].height);
    }
  }
}

Image error_of(const Picture& approximate, const Picture& exact) {
  Image error(exact.width, exact.height, 3);
  for (std::size_t k = 0; k < exact.colour.size(); ++k) {
    for (int c = 0; c < 3; ++c) error.data[3 * k + c] = approximate.colour[k][c] - exact.colour[k][c];
  }
  return error;
}

// Projects a pixel of one view, with its depth, into another view. Returns pixel coordinates and depth there.
glm::dvec3 seen_by(const shared::View& to, const shared::View& from, int x, int y, double z) {
  const glm::dvec4 lens = from.lens;
  const glm::dvec3 v((x + 0.5 - lens[2]) / lens[0] * z - from.row_x.w,
                     (y + 0.5 - lens[3]) / lens[1] * z - from.row_y.w, z - from.row_z.w);
  const glm::dmat3 axes(glm::dvec3(from.row_x), glm::dvec3(from.row_y), glm::dvec3(from.row_z));
  const glm::dvec3 p = axes * v + glm::dvec3(from.anchor) - glm::dvec3(to.anchor);
  const auto along = [&](const glm::vec4& row) { return glm::dot(glm::dvec3(row), p) + row.w; };
  const double depth = along(to.row_z);
  const glm::dvec4 eye = to.lens;
  return {eye[0] * along(to.row_x) / depth + eye[2] - 0.5, eye[1] * along(to.row_y) / depth + eye[3] - 0.5,
          depth};
}

// Interpolates between four pixels; x and y must lie within the picture.
glm::dvec3 bilinear(const Image& image, double x, double y) {
  const int x0 = std::min(static_cast<int>(x), image.width - 2 < 0 ? 0 : image.width - 2);
  const int y0 = std::min(static_cast<int>(y), image.height - 2 < 0 ? 0 : image.height - 2);
  const int x1 = std::min(x0 + 1, image.width - 1), y1 = std::min(y0 + 1, image.height - 1);
  glm::dvec3 colour;
  for (int c = 0; c < 3; ++c) {
    const double top = std::lerp(double{image.at(x0, y0, c)}, double{image.at(x1, y0, c)}, x - x0);
    const double low = std::lerp(double{image.at(x0, y1, c)}, double{image.at(x1, y1, c)}, x - x0);
    colour[c] = std::lerp(top, low, y - y0);
  }
  return colour;
}

// The position in the right picture that shows the same scene point as the left pixel (x, y). None if the
// right eye does not see this point.
std::optional<glm::dvec2> partner(const std::array<shared::View, 2>& views, const Image& left_depth,
                                  const Image& right_depth, int x, int y) {
  const double z = left_depth.at(x, y, 0);
  if (!std::isfinite(z)) return std::nullopt;
  const glm::dvec3 seen = seen_by(views[1], views[0], x, y, z);
  const bool inside = seen.x >= 0 && seen.y >= 0 && seen.x <= right_depth.width - 1 &&
                      seen.y <= right_depth.height - 1 && seen.z > 0;
  if (!inside) return std::nullopt;
  const double there =
      right_depth.at(static_cast<int>(std::lround(seen.x)), static_cast<int>(std::lround(seen.y)), 0);
  if (!(std::abs(there - seen.z) <= depth_tolerance * seen.z)) return std::nullopt;
  return glm::dvec2(seen);
}

struct Counted {
  double sum = 0.0;  // squared differences of channels
  std::size_t count = 0;
};

}  // namespace

Disagreement disagreement(const std::array<shared::View, 2>& views, std::span<const Picture> exact,
                          std::span<const Picture> approximate) {
  check_pair(views, exact);
  check_pair(views, approximate);
  const Image left_depth = depth_map(exact[0]), right_depth = depth_map(exact[1]);
  const Image approximate_depth = depth_map(approximate[0]);
  const Image left = error_of(approximate[0], exact[0]), right = error_of(approximate[1], exact[1]);
  Disagreement result;
  result.picture = Image(left.width, left.height, 3);
  result.right = left;
  result.disparity = Image(left.width, left.height, 1);
  std::ranges::fill(result.disparity.data, -1.0f);
  // The sums of the rows are added in order, so the result does not depend on threads.
  std::vector<Counted> rows(static_cast<std::size_t>(left.height));
  parallel_for(left.height, [&](int y) {
    Counted& row = rows[static_cast<std::size_t>(y)];
    for (int x = 0; x < left.width; ++x) {
      const auto at = partner(views, left_depth, right_depth, x, y);
      if (!at) continue;
      if (const double z = approximate_depth.at(x, y, 0); std::isfinite(z)) {
        const glm::dvec2 there(seen_by(views[1], views[0], x, y, z));
        result.disparity.at(x, y, 0) = static_cast<float>(glm::distance(there, *at));
      }
      const glm::dvec3 other = bilinear(right, at->x, at->y);
      for (int c = 0; c < 3; ++c) {
        const double d = left.at(x, y, c) - other[c];
        result.picture.at(x, y, c) = static_cast<float>(std::abs(d));
        result.right.at(x, y, c) = static_cast<float>(other[c]);
        row.sum += d * d;
      }
      ++row.count;
    }
  });
  double sum = 0.0;
  std::size_t count = 0;
  for (const Counted& row : rows) {
    sum += row.sum;
    count += row.count;
  }
  result.counted = static_cast<double>(count) / (static_cast<double>(left.width) * left.height);
  const double mean = sum / (3.0 * static_cast<double>(count));
  result.db = mean == 0.0 ? std::numeric_limits<double>::infinity() : -10.0 * std::log10(mean);
  return result;
}

}  // namespace binosplat::stereo
