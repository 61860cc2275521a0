#include "measure/depth_table.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/statistics.h"

namespace binosplat::measure {

DepthTableMeasurement::DepthTableMeasurement(const DepthTableSettings& settings) : settings_(settings) {
  if (settings.bins < 1 || (settings.far && !(*settings.far > 0.0f && std::isfinite(*settings.far)))) {
    fail("a table of {} bins over [0, {}]: expected at least one bin, and an end above 0", settings.bins,
         settings.far.value_or(0.0f));
  }
}

void DepthTableMeasurement::add(render::Frame& frame, const shared::View& view) {
  frame.draw(
      std::span(&view, 1),
      {{.transmittance = Transmittance::last, .order = settings_.order, .projection = settings_.projection}});
  const auto measured = frame.read_measured(0);
  measured_.insert(measured_.end(), measured.begin(), measured.end());
}

DepthTable DepthTableMeasurement::table() const {
  std::vector<double> depths;
  for (const auto& gaussian : measured_) depths.push_back(gaussian.depth);
  const double reach = depths.empty() ? 1.0 : quantile(std::move(depths), 0.95);
  DepthTable table{settings_.far.value_or(static_cast<float>(reach)), {}};
  table.bounds.resize(static_cast<std::size_t>(settings_.bins));
  for (const auto& gaussian : measured_) {
    const double bin = gaussian.depth / static_cast<double>(table.far) * settings_.bins;
    if (!(bin >= 0.0) || bin >= settings_.bins) continue;
    float& bound = table.bounds[static_cast<std::size_t>(bin)];
    bound = std::max(bound, gaussian.transmittance);
  }
  return table;
}

DepthTable measure_depth_table(render::Frame& frame, std::span<const shared::View> views,
                               const DepthTableSettings& settings) {
  DepthTableMeasurement measurement(settings);
  for (const shared::View& view : views) measurement.add(frame, view);
  return measurement.table();
}

}  // namespace binosplat::measure
