#pragma once
// Computes typical GPU times of frames, and reads the CPU time of this process.

#include <span>
#include <vector>

#include "base/clock.h"
#include "gl/context.h"
#include "lab/fields.h"
#include "render/frame.h"

namespace binosplat::lab {

using Reports = std::vector<Report>;

struct Typical {
  double frame_ms = 0.0;
  std::vector<StageTime> stages;  // ms
};

/// Returns medians over frames of one view, so that single slow frames do not count. Frames that measure
/// transmittance take longer: averages their median and that of the others, weighted by numbers of frames.
Typical typical_of(const Reports& frames);
/// Returns the mean of each time; the stages are those of the first element.
Typical mean_of(std::span<const Typical> all);

/// CPU time of this process's threads, and the time that they waited while other programs had the CPU, in ms.
struct CpuUse {
  double used = 0.0, waited = 0.0;

  /// Returns the times since the process started. If a GPU draws, returns zeros without reading them.
  static CpuUse now(const gl::Context& context);
  CpuUse since(const CpuUse& before) const { return {used - before.used, waited - before.waited}; }
  void operator+=(const CpuUse& other) { used += other.used, waited += other.waited; }
};

/// Stores the mean of the repeats, their noise, and the times of the slowest frames.
void put_times(const std::vector<double>& repeats, const std::vector<double>& all_ms, Row& row);
void put_stages(const std::vector<StageTime>& stages, Row& row);

/// Stores whether the GPU had its full clock (gl/full_clock.h) while it was timed. If not, warns.
void put_clock(bool full, Row& row);

/// Stores the CPU time and waiting of each repeat, per frame. Does nothing without repeats.
void put_cpu_times(const std::vector<CpuUse>& repeats, Row& row);

}  // namespace binosplat::lab
