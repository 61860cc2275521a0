#include "lab/threshold_variant.h"

#include <fmt/core.h>

#include "base/choices.h"

namespace binosplat::lab {

render::FrameSettings ThresholdVariant::settings() const {
  render::FrameSettings settings{{.threshold = threshold, .transmittance = transmittance}};
  if (!render::is_exact(threshold)) settings.tolerance = tolerance;
  return settings;
}

std::string ThresholdVariant::name() const {
  if (render::is_exact(threshold)) return name_of(threshold);
  return fmt::format("{}, {}", name_of(threshold), name_of(transmittance));
}

std::vector<ThresholdVariant> all_threshold_settings() {
  std::vector<ThresholdVariant> rules;
  for (const Threshold threshold : {Threshold::exact, Threshold::peripheral, Threshold::squared}) {
    for (const Transmittance source : {Transmittance::one, Transmittance::depth, Transmittance::last}) {
      if (render::can_use(threshold, source)) rules.push_back({threshold, source});
    }
  }
  return rules;
}

}  // namespace binosplat::lab
