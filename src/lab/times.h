#pragma once
// Frame times on the GPU, and typical values of them.

#include <span>
#include <vector>

#include "base/clock.h"
#include "gl/context.h"
#include "lab/results.h"
#include "render/frame.h"

namespace binosplat::lab {

/// The reports of successive frames.
using Reports = std::vector<render::FrameReport>;

/// Typical times of a frame.
struct Typical {
  double frame_ms = 0.0;
  std::vector<gl::StageTime> stages;  // ms
};

/// The medians over frames of one view, which ignore single slow frames. Frames that measure an error take
/// longer; the medians of both kinds are averaged by their counts.
Typical typical_of(const Reports& frames);
/// The mean. Takes the stages of the first element.
Typical mean_of(std::span<const Typical> all);

/// CPU time of this process's threads, and the time that they waited while others had the CPU, in ms.
struct CpuUse {
  double used = 0.0, waited = 0.0;

  /// Since the process started. Zero, at no cost, unless the CPU draws.
  static CpuUse now(const gl::Context& context);
  CpuUse since(const CpuUse& before) const { return {used - before.used, waited - before.waited}; }
  void operator+=(const CpuUse& other) { used += other.used, waited += other.waited; }
};

/// Stores the mean of the repeats, their noise, and the slowest frames.
void put_times(const std::vector<double>& repeats, const std::vector<double>& all_ms, Row& row);

/// Stores the time of each stage.
void put_stages(const std::vector<gl::StageTime>& stages, Row& row);

/// Stores the CPU time and waiting of each repeat, per frame. Does nothing without repeats.
void put_cpu_times(const std::vector<CpuUse>& repeats, Row& row);

/// Draws for `ms` to raise the clock of a GPU that was idle; a second or less suffices. Does nothing for a
/// software renderer.
template <typename Draw>
void raise_clock(const gl::Context& context, double ms, const Draw& draw) {
  if (context.software()) return;
  const auto start = Clock::now();
  while (ms_since(start) < ms) draw();
}

}  // namespace binosplat::lab
