#include "reference/transmittance.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "reference/blend_pixel.h"

namespace binosplat::reference {

namespace {

/// A Gaussian that a pixel blends, by its place in the tile's list.
struct Blended {
  std::size_t place;
  std::uint32_t gaussian;
  double alpha;
  PixelSum before;
};

/// RMS over channels.
double rms(const glm::dvec3& colour) { return std::sqrt(glm::dot(colour, colour) / 3.0); }

/// T * contrast of what a pixel blends. C_behind is what the Gaussian lets through divided by how much of it
/// gets through: (C_final - C_before - alpha T c) / (T (1 - alpha)), which is safe because the blend never
/// adds what leaves less than TRANSMITTANCE_MIN.
double transmittance_by_contrast(const Blended& blended, const glm::dvec3& colour,
                                 const glm::dvec3& final_colour, int contrast) {
  const double t = blended.before.transmittance;
  switch (contrast) {
    case CONTRAST_OFF:
      return t;
    case CONTRAST_FINAL:
      return t * rms(colour - final_colour);
    case CONTRAST_BEHIND:
      const glm::dvec3 rest = final_colour - blended.before.colour - blended.alpha * t * colour;
      return t * rms(colour - rest / (t * (1 - blended.alpha)));
  }
  fail("contrast {}: expected one of shared/axes.h", contrast);
}

/// The largest value(what a pixel blends, the pixel in the end) of each Gaussian.
template <typename Value>
std::vector<double> largest_by_gaussian(const std::vector<Splat>& splats, const TileLists& lists,
                                        const shared::View& view, const Value& value) {
  // Each tile measures for its own pairs; the largest of a Gaussian's pairs is taken afterwards.
  std::vector<double> of_pairs(lists.pairs(), 0.0);
  tbb::parallel_for(std::size_t{0}, lists.begin.size() - 1, [&](std::size_t t) {
    const int size = static_cast<int>(lists.tile_size);
    const auto tx = static_cast<int>(t % lists.tiles_x), ty = static_cast<int>(t / lists.tiles_x);
    const auto list = lists.tile(static_cast<std::uint32_t>(tx), static_cast<std::uint32_t>(ty));
    std::vector<Blended> way;
    for (int y = ty * size; y < std::min((ty + 1) * size, static_cast<int>(view.height)); ++y) {
      for (int x = tx * size; x < std::min((tx + 1) * size, static_cast<int>(view.width)); ++x) {
        way.clear();
        std::size_t place = 0;
        const PixelSum sum =
            blend_pixel(splats, list, x, y, {},
                        [&](std::uint32_t i, double alpha, const PixelSum& before, Verdict verdict) {
                          if (verdict == Verdict::blended) way.push_back({place, i, alpha, before});
                          ++place;
                        });
        for (const Blended& blended : way) {
          double& largest = of_pairs[lists.begin[t] + blended.place];
          largest = std::max(largest, value(blended, sum));
        }
      }
    }
  });
  std::vector<double> result(splats.size(), not_seen);
  for (std::size_t pair = 0; pair < lists.pairs(); ++pair) {
    double& largest = result[lists.gaussians[pair]];
    largest = std::max(largest, of_pairs[pair]);
  }
  return result;
}

}  // namespace

std::vector<double> measure_transmittance(const std::vector<Splat>& splats, const TileLists& lists,
                                          const shared::View& view, int contrast,
                                          const glm::dvec3& background) {
  return largest_by_gaussian(splats, lists, view, [&](const Blended& blended, const PixelSum& sum) {
    return transmittance_by_contrast(blended, splats[blended.gaussian].colour,
                                     sum.colour + sum.transmittance * background, contrast);
  });
}

std::vector<double> measure_contributions(const std::vector<Splat>& splats, const TileLists& lists,
                                          const shared::View& view) {
  return largest_by_gaussian(splats, lists, view, [](const Blended& blended, const PixelSum&) {
    return blended.alpha * blended.before.transmittance;
  });
}

std::vector<double> floored(std::vector<double> measured, double floor) {
  for (double& value : measured) value = value == not_seen ? 1.0 : std::max(floor, value);
  return measured;
}

}  // namespace binosplat::reference
