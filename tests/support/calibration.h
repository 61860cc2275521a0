#pragma once
// A threshold calibration with known numbers.

#include "adagscale/calibration.h"

namespace binosplat::test {

inline adagscale::ThresholdCalibration sample_calibration() {
  adagscale::ThresholdCalibration c;
  c.model_name = "fox.ply";
  c.gaussians = 109832;
  c.hash = 0x00ff39ddbc3922b3ull;
  c.perspective = {Order::distance, Projection::tangent};
  c.width = 518;
  c.height = 944;
  c.focal = 100.0;
  c.near_plane = 0.2;
  c.target = {adagscale::CalibrationTarget::Kind::drop, 0.5};
  c.depth_table = {8.5f, {1.0f, 0.25f, 0.0f}};
  c.views = {{"a", {0, 0, 0}}, {"b", {1, 0, 0}}, {"c", {1, 3, 0}}};
  c.reach = 6.0;
  c.entries = {{Threshold::adagscale, Transmittance::one, 2.0, 0.499, 0.75, "b", 0.25, 12, 0.5},
               {Threshold::squared, Transmittance::last, 0.01, 0.498, 0.6, "c", 0.5, 11, 0.25}};
  return c;
}

}  // namespace binosplat::test
