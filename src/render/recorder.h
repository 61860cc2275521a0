#pragma once
// Frames that follow one another, recorded for a profile.

#include <memory>
#include <string>
#include <vector>

#include "base/spans.h"
#include "gl/gpu_clock.h"
#include "render/frame_record.h"

namespace binosplat::render {

/// One moment on two clocks.
struct SameTime {
  Clock::time_point cpu = {};
  std::int64_t gpu_ns = 0;
};

/// What was recorded.
struct Recording {
  std::vector<FrameRecord> frames;
  std::vector<Span> spans;    // of the CPU's threads
  SameTime first, last;       // before and after all of it
  double fps = 0.0;           // frames were due so often a second; 0: as soon as the last one was drawn
  std::string no_clock = {};  // why frames have no `mhz`; empty: they have

  /// The ms that a frame may take; 0: nothing says so.
  double budget_ms() const { return fps > 0.0 ? 1000.0 / fps : 0.0; }
  /// When the CPU's clock showed what the GPU's did.
  Clock::time_point cpu_time(std::int64_t gpu_ns) const;
};

class Recorder {
 public:
  /// Begins. The context must outlive it, and be current in every call. The clock is asked for how fast it
  /// runs, if there is one.
  Recorder(const gl::Context& context, double fps, std::shared_ptr<const gl::GpuClock> clock);

  void add(FrameRecord frame);
  const std::vector<FrameRecord>& frames() const { return recording_.frames; }

  /// Ends, and hands it out.
  Recording finish();

 private:
  const gl::Context& context_;
  std::shared_ptr<const gl::GpuClock> clock_;
  Recording recording_;
};

}  // namespace binosplat::render
