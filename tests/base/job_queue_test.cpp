#include "base/job_queue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <stdexcept>
#include <thread>

namespace binosplat {
namespace {

TEST(JobQueue, DoesEachJobOnceAndOneThreadKeepsTheOrder) {
  for (const int threads : {1, 3}) {
    std::vector<int> begun, expected;
    std::mutex mutex;
    JobQueue queue(threads, 2);
    for (int k = 0; k < 200; ++k) {
      expected.push_back(k);
      queue.add([&, k] {
        const std::lock_guard lock(mutex);
        begun.push_back(k);
      });
    }
    queue.finish();
    if (threads > 1) std::sort(begun.begin(), begun.end());
    EXPECT_EQ(begun, expected);
  }
}

TEST(JobQueue, WhatFollowsJobsKeepsTheirOrder) {
  constexpr int jobs = 100;
  std::vector<int> order, expected;
  std::atomic<int> at_once = 0, most_at_once = 0, following = 0;
  JobQueue queue(4, 2);
  for (int k = 0; k < jobs; ++k) {
    expected.push_back(k);
    const auto work = [&at_once, &most_at_once, k] {
      const int now = ++at_once;
      for (int most = most_at_once; most < now && !most_at_once.compare_exchange_weak(most, now);) {
      }
      std::this_thread::sleep_for(
          std::chrono::microseconds(k % 3 == 0 ? 2000 : 100));  // later ones end first
      --at_once;
    };
    queue.add(work, [&order, &following, k] {
      EXPECT_EQ(++following, 1);
      order.push_back(k);
      --following;
    });
  }
  queue.finish();
  EXPECT_EQ(order, expected);
  EXPECT_GT(most_at_once, 1);
}

TEST(JobQueue, EndsWhereWhatFollowsAJobFails) {
  std::vector<int> order;
  JobQueue queue(3, 2);
  const auto add_all = [&] {
    for (int k = 0; k < 1000; ++k) {
      queue.add([] {},
                [&order, k] {
                  if (k == 7) throw std::runtime_error("the eighth");
                  order.push_back(k);
                });
    }
    queue.finish();
  };
  EXPECT_THROW(add_all(), std::runtime_error);
  EXPECT_THROW(queue.finish(), std::runtime_error);
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2, 3, 4, 5, 6}));
}

TEST(JobQueue, HoldsNoMoreThanItMay) {
  constexpr int threads = 2, waiting = 1;
  std::atomic<int> held = 0, most = 0;
  struct Held {
    explicit Held(std::atomic<int>& count) : count_(count) { ++count_; }
    ~Held() { --count_; }
    std::atomic<int>& count_;
  };
  JobQueue queue(threads, waiting);
  for (int k = 0; k < 40; ++k) {
    queue.add(
        [one = std::make_shared<Held>(held)] { std::this_thread::sleep_for(std::chrono::milliseconds(1)); });
    most = std::max(most.load(), held.load());
  }
  queue.finish();
  EXPECT_EQ(held, 0);
  EXPECT_LE(most, threads + waiting);
  EXPECT_EQ(most, threads + waiting);  // and uses all of them
}

TEST(JobQueue, EndsWithTheFirstFailure) {
  std::atomic<int> begun = 0;
  JobQueue queue(2, 2);
  EXPECT_THROW(
      {
        for (int k = 0; k < 1000; ++k) {
          queue.add([&begun, k] {
            ++begun;
            if (k == 6) throw std::runtime_error("the seventh");
            // Otherwise many jobs run before the failure is caught.
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
          });
        }
        queue.finish();
      },
      std::runtime_error);
  EXPECT_LT(begun, 20);
  EXPECT_THROW(queue.finish(), std::runtime_error);  // jobs that had begun have ended by now
  const int before = begun;
  EXPECT_THROW(queue.add([&begun] { ++begun; }), std::runtime_error);
  EXPECT_THROW(queue.finish(), std::runtime_error);
  EXPECT_EQ(begun, before);
}

TEST(JobQueue, EndsWithoutWhatNobodyWaitsFor) {
  std::atomic<int> done = 0;
  {
    JobQueue queue(1, 100);
    for (int k = 0; k < 100; ++k) {
      queue.add([&done] {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        ++done;
      });
    }
  }
  EXPECT_LT(done, 50);
}

std::vector<int> times_called(JobQueue& queue, std::size_t count, std::size_t chunk) {
  std::vector<std::atomic<int>> times(count);
  queue.share(count, chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) ++times[i];
  });
  return {times.begin(), times.end()};
}

TEST(JobQueue, SharesEachChunkOnce) {
  for (const int threads : {-1, 0, 1, 3}) {
    JobQueue queue(threads, 8);
    for (const std::size_t count : {0, 1, 2, 7, 1000, 12345}) {
      for (const std::size_t chunk : {1, 3, 1000, 20000}) {
        EXPECT_EQ(times_called(queue, count, chunk), std::vector<int>(count, 1))
            << threads << " threads, " << count << " by " << chunk;
      }
    }
  }
}

TEST(JobQueue, SharesWithAllItsThreads) {
  JobQueue queue(1, 8);
  std::atomic<int> there = 0;
  queue.share(2, 1, [&](std::size_t, std::size_t) {
    ++there;
    while (there < 2) std::this_thread::yield();  // a single thread would wait forever
  });
  EXPECT_EQ(there, 2);
}

TEST(JobQueue, SharesForSeveralThreadsAndWithinItself) {
  JobQueue queue(2, 8);
  std::atomic<int> wrong = 0;
  {
    std::vector<std::jthread> threads;
    for (int k = 0; k < 3; ++k) {
      threads.emplace_back([&] {
        for (int n = 0; n < 300; ++n) wrong += times_called(queue, 500, 7) != std::vector<int>(500, 1);
      });
    }
  }
  EXPECT_EQ(wrong, 0);
  std::atomic<int> inner = 0;
  queue.share(8, 1, [&](std::size_t, std::size_t) {
    queue.share(10, 1, [&](std::size_t begin, std::size_t end) { inner += static_cast<int>(end - begin); });
  });
  EXPECT_EQ(inner, 80);
}

}  // namespace
}  // namespace binosplat
