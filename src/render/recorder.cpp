#include "render/recorder.h"

#include <utility>

namespace binosplat::render {

namespace {

// Reads the GPU's clock between two readings of the CPU's, and keeps the closest of three tries.
ClockPair clock_pair(const gl::Context& context) {
  ClockPair best;
  Clock::duration least = Clock::duration::max();
  for (int k = 0; k < 3; ++k) {
    const auto begin = Clock::now();
    const std::int64_t gpu_ns = context.gpu_time_ns();
    const auto length = Clock::now() - begin;
    if (length >= least) continue;
    least = length;
    best = {begin + length / 2, gpu_ns};
  }
  return best;
}

}  // namespace

Clock::time_point Recording::cpu_time(std::int64_t gpu_ns) const {
  const double gpu_span = static_cast<double>(last.gpu_ns - first.gpu_ns);
  const double cpu_span = std::chrono::duration<double, std::nano>(last.cpu - first.cpu).count();
  const double rate = gpu_span > 0.0 ? cpu_span / gpu_span : 1.0;  // the clocks drift by some 10 us per s
  const double since = rate * static_cast<double>(gpu_ns - first.gpu_ns);
  return first.cpu + std::chrono::nanoseconds(static_cast<std::int64_t>(since));
}

Recorder::Recorder(const gl::Context& context, double fps, std::shared_ptr<const gl::GpuClock> clock)
    : context_(context), clock_(std::move(clock)) {
  recording_.fps = fps;
  if (!clock_) recording_.no_clock = "it was not requested";
  if (clock_) recording_.no_clock = clock_->problem();
  recording_.first = clock_pair(context);
  keep_spans();
}

void Recorder::add(FrameRecord frame) {
  if (clock_) frame.mhz = clock_->mhz();
  recording_.frames.push_back(std::move(frame));
}

Recording Recorder::finish() {
  recording_.spans = take_thread_spans();
  recording_.last = clock_pair(context_);
  return std::move(recording_);
}

}  // namespace binosplat::render
