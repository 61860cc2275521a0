#pragma once
// The distance of a frame's stages from the GPU's limits: the least bytes and operations of each, over the
// rates that small programs reach on the same GPU.

#include <cmath>
#include <string>
#include <vector>

#include "gl/dispatch.h"
#include "shared/axes.h"

namespace binosplat::lab {

/// Rates of a GPU, each the best of several runs.
struct Peaks {
  double bytes = 0.0;   // per second, read and written, copying buffer to buffer
  double alphas = 0.0;  // per second, evaluated and blended, four pixels an invocation
  double fmas = 0.0;    // fp32 multiply-adds per second
};

Peaks measure_peaks(gl::Context& context);

/// The work of a frame, or the mean of several.
struct FrameWork {
  double gaussians = 0.0;  // of the model
  int degree = 0;          // of its spherical harmonics
  int precision = PRECISION_FULL;
  double in_view = 0.0;          // Gaussians, summed over the order groups
  double splats = 0.0;           // of these, in all views
  double supertile_pairs = 0.0;  // binned and sorted
  double pairs = 0.0;
  double tiles = 0.0;   // of all views
  double pixels = 0.0;  // of all views
  double alphas = 0.0;  // evaluated before their pixels ended
  std::vector<gl::StageTime> stages;
};

/// A stage beside its floor. Values are NaN for stages without a floor (decode, probe).
struct StageFloor {
  std::string stage;
  double ms = 0.0;
  double bytes = NAN;       // least bytes to read and write
  double operations = NAN;  // alphas of `blend`, multiply-adds of `project`; else NaN
  double floor_ms = NAN;    // the longer of the two at the GPU's rates
  double share = NAN;       // floor_ms over ms
};

/// Returns stages in their order.
std::vector<StageFloor> profile(const FrameWork& work, const Peaks& peaks);

}  // namespace binosplat::lab
