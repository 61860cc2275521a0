#pragma once
// How near a frame's stages are to what the GPU could do at best: what each must read, write and compute at
// least, over rates that small programs reach on the same GPU.

#include <cmath>
#include <string>
#include <vector>

#include "gl/dispatch.h"
#include "shared/axes.h"

namespace binosplat::lab {

/// Rates of a GPU, each of the best of some runs.
struct Peaks {
  double bytes = 0.0;   // per second, read and written, of a copy from buffer to buffer
  double alphas = 0.0;  // per second, evaluated and blended, four pixels an invocation
  double fmas = 0.0;    // fp32 multiply-adds per second
};

Peaks measure_peaks(gl::Context& context);

/// What a frame had to do, or the mean of some.
struct FrameWork {
  double gaussians = 0.0;  // of the model
  int degree = 0;          // of its SH
  int precision = PRECISION_FULL;
  double in_view = 0.0;          // Gaussians, summed over the order groups
  double splats = 0.0;           // of those, one a view
  double supertile_pairs = 0.0;  // that are binned and sorted
  double pairs = 0.0;
  double tiles = 0.0;   // of all views
  double pixels = 0.0;  // likewise
  double alphas = 0.0;  // evaluated by pixels that still took light
  std::vector<gl::StageTime> stages;
};

/// A stage beside what the GPU could do at best; not a number for stages without a floor (decode, probe).
struct StageFloor {
  std::string stage;
  double ms = 0.0;
  double bytes = NAN;       // that it must read and write at least
  double operations = NAN;  // alphas of `blend`, multiply-adds of `project`; others have none
  double floor_ms = NAN;    // the longer of the two at the GPU's rates
  double share = NAN;       // of the time, that the floor is
};

/// In the order of the stages.
std::vector<StageFloor> profile(const FrameWork& work, const Peaks& peaks);

}  // namespace binosplat::lab
