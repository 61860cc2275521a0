#include "lab/rule.h"

#include <fmt/core.h>

namespace binosplat::lab {

render::FrameSettings Rule::settings() const {
  return {.th = th, .transmittance = transmittance, .tolerance = tolerance};
}

std::string Rule::name() const {
  if (render::is_exact(th)) return th_choices[th].name;
  return fmt::format("{}, {}", th_choices[th].name, transmittance_choices[transmittance].name);
}

std::vector<Rule> all_rules() {
  std::vector<Rule> rules;
  for (int th = 0; th < std::ssize(th_choices); ++th) {
    for (int source = 0; source < std::ssize(transmittance_choices); ++source) {
      if (render::can_use(th, source)) rules.push_back({th, source});
    }
  }
  return rules;
}

}  // namespace binosplat::lab
