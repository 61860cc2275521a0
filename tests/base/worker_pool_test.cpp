#include "base/worker_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace binosplat {
namespace {

std::vector<int> times_called(WorkerPool& pool, std::size_t count, std::size_t chunk) {
  std::vector<std::atomic<int>> times(count);
  pool.run(count, chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) ++times[i];
  });
  return {times.begin(), times.end()};
}

TEST(WorkerPool, WorksOnEachOnce) {
  for (const int threads : {-1, 0, 1, 3}) {
    WorkerPool pool(threads);
    for (const std::size_t count : {0, 1, 2, 7, 1000, 12345}) {
      for (const std::size_t chunk : {1, 3, 1000, 20000}) {
        EXPECT_EQ(times_called(pool, count, chunk), std::vector<int>(count, 1))
            << threads << " threads, " << count << " by " << chunk;
      }
    }
  }
}

TEST(WorkerPool, IsOfAllItsThreads) {
  WorkerPool pool(1);
  std::atomic<int> there = 0;
  pool.run(2, 1, [&](std::size_t, std::size_t) {
    ++there;
    while (there < 2) std::this_thread::yield();  // alone it would wait forever
  });
  EXPECT_EQ(there, 2);
}

TEST(WorkerPool, WorksForSeveralThreadsAtATime) {
  WorkerPool pool(2);
  std::atomic<int> wrong = 0;
  {
    std::vector<std::jthread> threads;
    for (int k = 0; k < 3; ++k) {
      threads.emplace_back([&] {
        for (int n = 0; n < 300; ++n) wrong += times_called(pool, 500, 7) != std::vector<int>(500, 1);
      });
    }
  }
  EXPECT_EQ(wrong, 0);
}

TEST(WorkerPool, WorksWhereItIsAtWorkAlready) {
  WorkerPool pool(2);
  std::atomic<int> inner = 0;
  pool.run(8, 1, [&](std::size_t, std::size_t) {
    pool.run(10, 1, [&](std::size_t begin, std::size_t end) { inner += static_cast<int>(end - begin); });
  });
  EXPECT_EQ(inner, 80);
}

}  // namespace
}  // namespace binosplat
