#include "adagscale/depth_table.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "base/statistics.h"

namespace binosplat::adagscale {

DepthTable measure_depth_table(render::Frame& frame, std::span<const shared::View> views,
                               const DepthTableSettings& settings) {
  if (settings.bins < 1 || (settings.far && !(*settings.far > 0.0f && std::isfinite(*settings.far)))) {
    fail("a table of {} bins over [0, {}]: expected at least one bin, and an end above 0", settings.bins,
         settings.far.value_or(0.0f));
  }
  render::FrameSettings measuring = render::exact_of(settings.frame);
  measuring.precision = settings.frame.precision;
  measuring.transmittance = Transmittance::last;
  std::vector<render::MeasuredGaussian> measured;
  for (const shared::View& view : views) {
    frame.draw(std::span(&view, 1), measuring);
    const auto of_view = frame.read_measured(0);
    measured.insert(measured.end(), of_view.begin(), of_view.end());
  }
  std::vector<double> depths;
  for (const auto& gaussian : measured) depths.push_back(gaussian.depth);
  const double reach = depths.empty() ? 1.0 : quantile(std::move(depths), 0.95);
  DepthTable table{settings.far.value_or(static_cast<float>(reach)), {}};
  table.bounds.resize(static_cast<std::size_t>(settings.bins));
  for (const auto& gaussian : measured) {
    const double bin = gaussian.depth / static_cast<double>(table.far) * settings.bins;
    if (!(bin >= 0.0) || bin >= settings.bins) continue;
    float& bound = table.bounds[static_cast<std::size_t>(bin)];
    bound = std::max(bound, gaussian.transmittance);
  }
  return table;
}

}  // namespace binosplat::adagscale
