// A slow clock is injected: the probe's times are given.

#include "gl/full_clock.h"

#include <gtest/gtest.h>

#include <vector>

#include "support/gl.h"

namespace binosplat::gl {
namespace {

struct Outcome {
  int calls = 0;
  bool counts = false;
};

/// Measures with probes that take these times in turn; the last one repeats.
Outcome measured(const std::vector<double>& probes_ms) {
  std::size_t at = 0;
  FullClock clock([&] { return probes_ms[std::min(at++, probes_ms.size() - 1)]; });
  Outcome out;
  out.counts = clock.measure([&] { ++out.calls; });
  return out;
}

TEST(FullClock, SteadyClockMeasuresOnce) {
  const Outcome steady = measured({1.0, 1.04, 1.0});
  EXPECT_TRUE(steady.counts);
  EXPECT_EQ(steady.calls, 1);
}

TEST(FullClock, SlowClockMeasuresAgain) {
  const Outcome falls = measured({1.0, 1.1, 1.0, 1.0}), rises = measured({2.0, 1.0});
  EXPECT_TRUE(falls.counts) << "the clock fell while the first call ran";
  EXPECT_EQ(falls.calls, 2);
  EXPECT_TRUE(rises.counts) << "the clock rose while the first call ran";
  EXPECT_EQ(rises.calls, 2);
}

TEST(FullClock, LastingSlowClockIsReported) {
  const Outcome slow = measured({1.0, 2.0});
  EXPECT_FALSE(slow.counts);
  EXPECT_EQ(slow.calls, 5);
}

TEST(FullClock, HighestClockIsRemembered) {
  double probe_ms = 1.0;
  FullClock clock([&] { return probe_ms; });
  EXPECT_TRUE(clock.measure([] {}));
  probe_ms = 1.2;
  EXPECT_FALSE(clock.measure([] {}));
}

TEST(FullClock, SoftwareRendererMeasuresOnce) {
  FullClock clock(test::gl_context());
  int calls = 0;
  EXPECT_TRUE(clock.measure([&] { ++calls; }));
  EXPECT_TRUE(calls == 1 || !test::gl_context().software());
}

}  // namespace
}  // namespace binosplat::gl
