#include "lab/rule.h"

#include <fmt/core.h>

#include "base/choices.h"

namespace binosplat::lab {

render::FrameSettings Rule::settings() const {
  render::FrameSettings settings{{.threshold = th, .transmittance = transmittance}};
  if (!render::is_exact(th)) settings.tolerance = tolerance;
  return settings;
}

std::string Rule::name() const {
  if (render::is_exact(th)) return name_of(th);
  return fmt::format("{}, {}", name_of(th), name_of(transmittance));
}

std::vector<Rule> all_rules() {
  std::vector<Rule> rules;
  for (const Threshold th : {Threshold::exact, Threshold::peripheral, Threshold::squared}) {
    for (const Transmittance source : {Transmittance::one, Transmittance::depth, Transmittance::last}) {
      if (render::can_use(th, source)) rules.push_back({th, source});
    }
  }
  return rules;
}

}  // namespace binosplat::lab
