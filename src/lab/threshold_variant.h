#pragma once
// A threshold rule of measurements: threshold, source of its transmittance bound, and tolerance.

#include <string>
#include <vector>

#include "render/frame_settings.h"

namespace binosplat::lab {

struct ThresholdVariant {
  Threshold threshold = Threshold::squared;
  Transmittance transmittance = Transmittance::one;
  float tolerance = 0.0f;

  render::FrameSettings settings() const;
  std::string name() const;  // "squared, last"
};

/// Every threshold with every source that it supports, the exact one first. Tolerances are 0.
std::vector<ThresholdVariant> all_threshold_settings();

}  // namespace binosplat::lab
