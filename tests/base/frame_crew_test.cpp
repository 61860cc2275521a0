#include "base/frame_crew.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace binosplat {
namespace {

std::vector<int> times_called(FrameCrew& crew, std::size_t count, std::size_t chunk) {
  std::vector<std::atomic<int>> times(count);
  crew.run(count, chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) ++times[i];
  });
  return {times.begin(), times.end()};
}

TEST(FrameCrew, WorksOnEachOnce) {
  for (const int threads : {-1, 0, 1, 3}) {
    FrameCrew crew(threads);
    for (const std::size_t count : {0, 1, 2, 7, 1000, 12345}) {
      for (const std::size_t chunk : {1, 3, 1000, 20000}) {
        EXPECT_EQ(times_called(crew, count, chunk), std::vector<int>(count, 1))
            << threads << " threads, " << count << " by " << chunk;
      }
    }
  }
}

TEST(FrameCrew, IsOfAllItsThreads) {
  FrameCrew crew(1);
  std::atomic<int> there = 0;
  crew.run(2, 1, [&](std::size_t, std::size_t) {
    ++there;
    while (there < 2) std::this_thread::yield();  // alone it would wait forever
  });
  EXPECT_EQ(there, 2);
}

TEST(FrameCrew, WorksForSeveralThreadsAtATime) {
  FrameCrew crew(2);
  std::atomic<int> wrong = 0;
  {
    std::vector<std::jthread> threads;
    for (int k = 0; k < 3; ++k) {
      threads.emplace_back([&] {
        for (int n = 0; n < 300; ++n) wrong += times_called(crew, 500, 7) != std::vector<int>(500, 1);
      });
    }
  }
  EXPECT_EQ(wrong, 0);
}

TEST(FrameCrew, WorksWhereItIsAtWorkAlready) {
  FrameCrew crew(2);
  std::atomic<int> inner = 0;
  crew.run(8, 1, [&](std::size_t, std::size_t) {
    crew.run(10, 1, [&](std::size_t begin, std::size_t end) { inner += static_cast<int>(end - begin); });
  });
  EXPECT_EQ(inner, 80);
}

}  // namespace
}  // namespace binosplat
