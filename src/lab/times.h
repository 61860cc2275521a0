#pragma once
// What frames take: GPU times, and what is typical of them.

#include <span>
#include <vector>

#include "base/clock.h"
#include "gl/context.h"
#include "lab/results.h"
#include "render/frame.h"

namespace binosplat::lab {

/// The reports of frames that follow one another.
using Reports = std::vector<render::FrameReport>;

/// What a frame takes.
struct Typical {
  double frame_ms = 0.0;
  std::vector<gl::StageTime> stages;  // ms
};

/// The medians of frames of one view, which a slow frame does not move. Those that measure for the others
/// take longer: both kinds count by their numbers.
Typical typical_of(const Reports& frames);
/// The mean; the stages are the first one's.
Typical mean_of(std::span<const Typical> all);

/// What the threads of this process had of the CPU, and how long they were ready while others had it, in ms.
struct CpuUse {
  double used = 0.0, waited = 0.0;

  /// Since the process began, where the CPU draws; else nothing, and no time is spent on it.
  static CpuUse now(const gl::Context& context);
  CpuUse since(const CpuUse& before) const { return {used - before.used, waited - before.waited}; }
  void operator+=(const CpuUse& other) { used += other.used, waited += other.waited; }
};

/// Puts what repeats of a time come to, their spread, and what of all frames takes longest.
void put_times(const std::vector<double>& repeats, const std::vector<double>& all_ms, Row& row);

/// Puts the time of each stage.
void put_stages(const std::vector<gl::StageTime>& stages, Row& row);

/// The same of the CPU, where it draws: what each repeat used and waited a frame. None: it does not draw.
void put_cpu_times(const std::vector<CpuUse>& repeats, Row& row);

/// Draws for so long, a second or a little less, after which the clock of a GPU that waited is up again. A
/// software renderer has none.
template <typename Draw>
void wake(const gl::Context& context, double ms, const Draw& draw) {
  if (context.software()) return;
  const auto start = Clock::now();
  while (ms_since(start) < ms) draw();
}

}  // namespace binosplat::lab
