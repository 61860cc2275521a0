#include "measure/depth_table.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/statistics.h"

namespace binosplat::measure {

render::DepthTable measure_depth_table(render::Frame& frame, std::span<const shared::View> views,
                                       const DepthTableSettings& settings) {
  if (settings.bins < 1 || (settings.far && !(*settings.far > 0.0f && std::isfinite(*settings.far)))) {
    fail("a table of {} bins over [0, {}]: expected at least one bin, and an end above 0", settings.bins,
         settings.far.value_or(0.0f));
  }
  std::vector<render::MeasuredGaussian> all;
  for (const shared::View& view : views) {
    frame.draw(
        std::span(&view, 1),
        {.transmittance = TRANSMITTANCE_LAST, .order = settings.order, .projection = settings.projection});
    const auto measured = frame.read_measured(0);
    all.insert(all.end(), measured.begin(), measured.end());
  }
  std::vector<double> depths;
  for (const auto& gaussian : all) depths.push_back(gaussian.depth);
  const double reach = depths.empty() ? 1.0 : quantile(std::move(depths), 0.95);
  render::DepthTable table{settings.far.value_or(static_cast<float>(reach)), {}};
  table.bounds.resize(static_cast<std::size_t>(settings.bins));
  for (const auto& gaussian : all) {
    const double bin = gaussian.depth / static_cast<double>(table.far) * settings.bins;
    if (!(bin >= 0.0) || bin >= settings.bins) continue;
    float& bound = table.bounds[static_cast<std::size_t>(bin)];
    bound = std::max(bound, gaussian.transmittance);
  }
  return table;
}

}  // namespace binosplat::measure
