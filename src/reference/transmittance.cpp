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

/// Measures pixel by pixel, a tile for its own pairs; the pairs of a Gaussian are brought together
/// afterwards, so that threads do not matter. `measure(of_pair, blended, final_colour)` changes what the pair
/// has so far, `join(of_gaussian, of_pair)` what the Gaussian has, from `start` on.
template <typename Measure, typename Join>
std::vector<double> measure_pairs(const std::vector<Splat>& splats, const TileLists& lists,
                                  const shared::View& view, const glm::dvec3& background, double start,
                                  const Measure& measure, const Join& join) {
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
        const glm::dvec3 final_colour = sum.colour + sum.transmittance * background;
        for (const Blended& blended : way)
          measure(of_pairs[lists.begin[t] + blended.place], blended, final_colour);
      }
    }
  });
  std::vector<double> result(splats.size(), start);
  for (std::size_t pair = 0; pair < lists.pairs(); ++pair)
    join(result[lists.gaussians[pair]], of_pairs[pair]);
  return result;
}

void keep_largest(double& largest, double value) { largest = std::max(largest, value); }

}  // namespace

std::vector<double> measure_transmittance(const std::vector<Splat>& splats, const TileLists& lists,
                                          const shared::View& view, int contrast,
                                          const glm::dvec3& background) {
  const auto measure = [&](double& largest, const Blended& blended, const glm::dvec3& final_colour) {
    keep_largest(largest,
                 transmittance_by_contrast(blended, splats[blended.gaussian].colour, final_colour, contrast));
  };
  return measure_pairs(splats, lists, view, background, not_seen, measure, keep_largest);
}

std::vector<double> measure_contributions(const std::vector<Splat>& splats, const TileLists& lists,
                                          const shared::View& view) {
  const auto measure = [](double& largest, const Blended& blended, const glm::dvec3&) {
    keep_largest(largest, blended.alpha * blended.before.transmittance);
  };
  return measure_pairs(splats, lists, view, glm::dvec3(0.0), not_seen, measure, keep_largest);
}

std::vector<double> measure_weights(const std::vector<Splat>& splats, const TileLists& lists,
                                    const shared::View& view) {
  const auto measure = [](double& sum, const Blended& blended, const glm::dvec3&) {
    sum += blended.alpha * blended.before.transmittance;
  };
  const auto join = [](double& sum, double more) { sum += more; };
  return measure_pairs(splats, lists, view, glm::dvec3(0.0), 0.0, measure, join);
}

std::vector<double> floored(std::vector<double> measured, double floor) {
  for (double& value : measured) value = value == not_seen ? 1.0 : std::max(floor, value);
  return measured;
}

}  // namespace binosplat::reference
