#include "base/thread_spans.h"

#include <gtest/gtest.h>

#include <thread>

namespace binosplat {
namespace {

TEST(Spans, RecordAllThreads) {
  { const TimedSpan before("before"); }
  keep_spans();
  double ms = 0.0;
  {
    const TimedSpan outer("outer", &ms);
    const TimedSpan inner("inner");
    std::thread([] {
      name_thread("reads");
      add_span("read " + std::to_string(1), Clock::now());
    }).join();
  }
  const std::vector<ThreadSpan> spans = take_thread_spans();
  { const TimedSpan after("after"); }
  ASSERT_EQ(spans.size(), 3u);
  EXPECT_EQ(spans[0].name, "read 1");
  EXPECT_EQ(spans[0].thread, "reads");
  EXPECT_EQ(spans[1].name, "inner");
  EXPECT_EQ(spans[2].name, "outer");
  EXPECT_EQ(spans[2].thread, "draws");
  EXPECT_LE(spans[2].begin, spans[1].begin);
  EXPECT_LE(spans[1].end, spans[2].end);
  const std::chrono::duration<double, std::milli> of_inner = spans[1].end - spans[1].begin;
  EXPECT_GE(ms, of_inner.count());
  EXPECT_TRUE(take_thread_spans().empty());
}

TEST(Spans, SumWithoutRecording) {
  double ms = 0.0;
  {
    const TimedSpan span("sleep", &ms);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_GE(ms, 2.0);
}

// A frame has about ten spans. A headset's frame takes 11 ms, and 2 % of it are 220 us.
TEST(Spans, HaveLittleOverhead) {
  keep_spans();
  const auto start = Clock::now();
  for (int n = 0; n < 100'000; ++n) const TimedSpan span("one of many");
  EXPECT_LT(ms_since(start), 1000.0) << "10 us each";
  EXPECT_EQ(take_thread_spans().size(), 100'000u);
}

}  // namespace
}  // namespace binosplat
