#include "gl/full_clock.h"

#include <algorithm>
#include <memory>
#include <vector>

#include "base/clock.h"
#include "gl/buffer.h"
#include "gl/dispatch.h"
#include "gl/state.h"

namespace binosplat::gl {

namespace {

constexpr double full_share = 0.95;  // of the highest clock
constexpr int max_calls = 5;
constexpr double rise_ms = 1000.0;  // an idle GPU reaches its full clock within about 300 ms

/// The shortest of three dispatches: another program may interrupt one.
double probe_ms(Context& context, const Buffer& chain) {
  const SavedState saved(context);
  Dispatcher dispatcher(context);
  double shortest = INFINITY;
  for (int n = 0; n < 3; ++n) {
    dispatcher.begin_frame();
    dispatcher.begin_stage("clock");
    dispatcher.run(context.program("clock_probe.comp"), DispatchSize::of_groups(1), {{"Chain", chain}});
    dispatcher.end_frame();
    shortest = std::min(shortest, time_of(dispatcher.wait_and_time(), "clock"));
  }
  return shortest;
}

}  // namespace

FullClock::FullClock(Context& context) {
  if (context.software()) return;
  const auto chain = std::make_shared<Buffer>(context, "chain of the clock's probe");
  chain->upload(std::vector<float>(32, 1.0f));
  probe_ms_ = [&context, chain] { return probe_ms(context, *chain); };
  for (const auto start = Clock::now(); ms_since(start) < rise_ms;) probe();
}

double FullClock::probe() {
  const double ms = probe_ms_ ? probe_ms_() : 1.0;
  shortest_ms_ = std::min(shortest_ms_, ms);
  return ms;
}

bool FullClock::measure(const std::function<void()>& measure) {
  for (int call = 1;; ++call) {
    const double before = probe();
    measure();
    const double longest = std::max(before, probe());
    if (longest * full_share <= shortest_ms_) return true;
    if (call == max_calls) return false;
  }
}

}  // namespace binosplat::gl
