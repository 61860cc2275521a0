#include "reference/adagscale_transmittance.h"

#include <algorithm>

#include "base/parallel.h"
#include "reference/blend_pixel.h"

namespace binosplat::reference {

namespace {

/// Measures each splat-tile pair, and then joins the pairs of each Gaussian in order, so that the result does
/// not depend on threads. `measure(of_pair, alpha, transmittance)` updates a pair's value, which begins at 0.
/// `join(of_gaussian, of_pair)` updates a Gaussian's value, which begins at `start`.
template <typename Measure, typename Join>
std::vector<double> measure_pairs(const std::vector<Splat>& splats, const TileLists& lists,
                                  const shared::View& view, double start, const Measure& measure,
                                  const Join& join) {
  std::vector<double> of_pairs(lists.pairs(), 0.0);
  parallel_for(lists.begin.size() - 1, [&](std::size_t t) {
    const auto tx = static_cast<int>(t % lists.tiles_x), ty = static_cast<int>(t / lists.tiles_x);
    const auto list = lists.tile(static_cast<std::uint32_t>(tx), static_cast<std::uint32_t>(ty));
    for (int y = ty * TILE_SIZE; y < std::min((ty + 1) * TILE_SIZE, static_cast<int>(view.height)); ++y) {
      for (int x = tx * TILE_SIZE; x < std::min((tx + 1) * TILE_SIZE, static_cast<int>(view.width)); ++x) {
        std::size_t pair = lists.begin[t];
        blend_pixel(splats, list, {x, y}, {},
                    [&](std::uint32_t, double alpha, const PixelSum& before, Verdict verdict) {
                      if (verdict == Verdict::blended) measure(of_pairs[pair], alpha, before.transmittance);
                      ++pair;
                    });
      }
    }
  });
  std::vector<double> result(splats.size(), start);
  for (std::size_t pair = 0; pair < lists.pairs(); ++pair)
    join(result[lists.gaussians[pair]], of_pairs[pair]);
  return result;
}

void keep_largest(double& largest, double value) { largest = std::max(largest, value); }
void add_up(double& sum, double value) { sum += value; }

}  // namespace

std::vector<double> measure_transmittance(const std::vector<Splat>& splats, const TileLists& lists,
                                          const shared::View& view) {
  const auto measure = [](double& largest, double, double transmittance) {
    keep_largest(largest, transmittance);
  };
  return measure_pairs(splats, lists, view, not_seen, measure, keep_largest);
}

std::vector<double> measure_weights(const std::vector<Splat>& splats, const TileLists& lists,
                                    const shared::View& view) {
  const auto measure = [](double& sum, double alpha, double transmittance) { sum += alpha * transmittance; };
  return measure_pairs(splats, lists, view, 0.0, measure, add_up);
}

std::vector<double> measure_visibility(const std::vector<Splat>& splats, const TileLists& lists,
                                       const shared::View& view) {
  const auto measure = [](double& sum, double alpha, double transmittance) {
    if (transmittance >= VISIBILITY_MIN) sum += alpha * transmittance * transmittance;
  };
  return measure_pairs(splats, lists, view, 0.0, measure, add_up);
}

std::vector<double> floored(std::vector<double> measured, double floor) {
  for (double& value : measured) value = value == not_seen ? 1.0 : std::max(floor, value);
  return measured;
}

}  // namespace binosplat::reference
