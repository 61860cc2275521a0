#pragma once
// Records successive frames for a profile.

#include <memory>
#include <string>
#include <vector>

#include "base/thread_spans.h"
#include "gl/gpu_clock.h"
#include "render/profiled_frame.h"

namespace binosplat::render {

/// One moment on two clocks.
struct ClockPair {
  Clock::time_point cpu = {};
  std::int64_t gpu_ns = 0;
};

struct Recording {
  std::vector<FrameRecord> frames;
  std::vector<ThreadSpan> spans;  // of the CPU's threads
  ClockPair first, last;          // at the begin and the end of the recording
  double fps = 0.0;           // scheduled frames per second; 0: a frame begins when the previous one is done
  std::string no_clock = {};  // why FrameRecord::mhz is missing; empty: it is there

  /// The ms of a frame's period; 0 without a schedule.
  double budget_ms() const { return fps > 0.0 ? 1000.0 / fps : 0.0; }
  Clock::time_point cpu_time(std::int64_t gpu_ns) const;
};

class Recorder {
 public:
  /// Starts the recording. The context must outlive the Recorder, and be current in every call. Reads the
  /// GPU's clock rate from `clock`, unless `clock` is null.
  Recorder(const gl::Context& context, double fps, std::shared_ptr<const gl::GpuClock> clock);

  void add(FrameRecord frame);
  const std::vector<FrameRecord>& frames() const { return recording_.frames; }

  Recording finish();

 private:
  const gl::Context& context_;
  std::shared_ptr<const gl::GpuClock> clock_;
  Recording recording_;
};

}  // namespace binosplat::render
