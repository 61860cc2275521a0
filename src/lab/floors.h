#pragma once
// Computes the floor of each stage's time: the least bytes and operations that the stage needs, divided by
// the rates that small programs reach on the same GPU.

#include <cmath>
#include <string>
#include <vector>

#include "gl/dispatch.h"
#include "shared/axes.h"

namespace binosplat::lab {

/// Rates of a GPU, each the best of several runs.
struct Peaks {
  double bytes = 0.0;   // bytes read plus bytes written per second, in a copy between buffers
  double alphas = 0.0;  // alphas evaluated and blended per second, four pixels per invocation
  double fmas = 0.0;    // fp32 multiply-adds per second
};

Peaks measure_peaks(gl::Context& context);

/// The work of a frame, or the mean work of several frames.
struct FrameWork {
  double gaussians = 0.0;  // of the model
  int degree = 0;          // of its spherical harmonics
  int precision = PRECISION_FULL;
  double in_view = 0.0;          // Gaussians in view, summed over the order groups
  double splats = 0.0;           // of all views
  double supertile_pairs = 0.0;  // entries that are binned and sorted
  double pairs = 0.0;
  double tiles = 0.0;   // of all views
  double pixels = 0.0;  // of all views
  double alphas = 0.0;  // alphas evaluated; a pixel whose blend has ended evaluates no more
  std::vector<gl::StageTime> stages;
};

/// The time and the floor of a stage. Values are NaN for stages without a floor (decode, probe).
struct StageFloor {
  std::string stage;
  double ms = 0.0;
  double bytes = NAN;       // least bytes to read and write
  double operations = NAN;  // alphas of `blend`, multiply-adds of `project`; else NaN
  double floor_ms = NAN;    // time for the bytes or for the operations, whichever takes longer
  double share = NAN;       // floor_ms over ms
};

/// Returns one element for each of work.stages, in the same order.
std::vector<StageFloor> profile(const FrameWork& work, const Peaks& peaks);

}  // namespace binosplat::lab
