#include "base/parallel.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "base/parallel_in_frame.h"
#include "base/parallel_sort.h"

namespace binosplat {
namespace {

std::string thrown_by(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "nothing";
}

TEST(Parallel, ChunksCoverRange) {
  for (const auto& cover : {parallel_chunks, parallel_in_frame}) {
    for (const std::size_t count : {0, 1, 2, 63, 64, 1000, 12345}) {
      for (const std::size_t chunk : {1, 7, 1000, 20000}) {
        std::vector<std::atomic<int>> times(count);
        cover(count, chunk, [&](std::size_t begin, std::size_t end) {
          EXPECT_LT(begin, end);
          for (std::size_t i = begin; i < end; ++i) ++times[i];
        });
        EXPECT_EQ(std::vector<int>(times.begin(), times.end()), std::vector<int>(count, 1))
            << count << " by " << chunk;
      }
    }
  }
}

TEST(Parallel, LoopsNest) {
  std::atomic<int> sum = 0;
  parallel_for(20, [&](int i) {
    parallel_for(20, [&](int j) { parallel_for(20, [&](int k) { sum += i + j * k; }); });
  });
  EXPECT_EQ(sum, 190 * 400 + 20 * 190 * 190);
}

TEST(Parallel, LoopRethrows) {
  const auto fails = [](int i) {
    if (i == 77) throw std::runtime_error("77");
  };
  EXPECT_EQ(thrown_by([&] { parallel_for(100, fails); }), "77");
  EXPECT_EQ(thrown_by([&] { parallel_for(10, [&](int i) { parallel_for(10 * i, fails); }); }), "77");
  EXPECT_EQ(thrown_by([&] { parallel_for(10, [&](int i) { fails(i + 77 - 9); }); }), "77");
  EXPECT_EQ(thrown_by([&] { parallel_for(77, fails); }), "nothing");
}

TEST(Parallel, SortEqualsSingleThread) {
  std::mt19937 random(1);
  for (const std::size_t count : {0, 1, 2, 8192, 8193, 20'000, 300'000}) {
    for (const std::uint32_t different : {1u, 2u, 300u, ~0u}) {
      std::vector<std::uint32_t> values(count);
      for (std::uint32_t& value : values) value = static_cast<std::uint32_t>(random()) % different;
      std::vector<std::uint32_t> sorted = values, rising = values;
      std::sort(sorted.begin(), sorted.end());
      parallel_sort(rising.begin(), rising.end());
      EXPECT_EQ(rising, sorted) << count << ", " << different << " different";
      parallel_sort(rising.begin(), rising.end());
      EXPECT_EQ(rising, sorted) << count << " again";
      parallel_sort(values.begin(), values.end(), std::greater<>());
      std::ranges::reverse(sorted);
      EXPECT_EQ(values, sorted) << count << " falling";
    }
  }
}

TEST(ParallelStages, HandOverInOrder) {
  for (const std::size_t count : {0, 1, 2, 100}) {
    std::vector<int> results(count);
    std::vector<int> handed;
    parallel_stages(
        16, [&](std::size_t k) { return k < count; },
        [&](std::size_t k) { results[k] = static_cast<int>(k * k); },
        [&](std::size_t k) { handed.push_back(results[k]); }, HandOver::in_order);
    std::vector<int> squares;
    for (std::size_t k = 0; k < count; ++k) squares.push_back(static_cast<int>(k * k));
    EXPECT_EQ(handed, squares);
  }
}

TEST(ParallelStages, LimitConcurrency) {
  for (const HandOver how : {HandOver::in_order, HandOver::as_done}) {
    for (const std::size_t ahead : {1, 3}) {
      std::atomic<std::size_t> begun = 0, most = 0;
      std::size_t handed = 0;
      parallel_stages(
          ahead,
          [&](std::size_t k) {
            begun = k + 1;
            return k < 200;
          },
          [](std::size_t) { std::this_thread::yield(); },
          [&](std::size_t) {
            most = std::max<std::size_t>(most, std::min<std::size_t>(begun, 200) - handed++);
          },
          how);
      EXPECT_EQ(handed, 200u);
      EXPECT_LE(most, ahead + 1) << "one may be asked about that does not begin yet";
    }
  }
}

TEST(ParallelStages, SlowStageBlocksNoOther) {
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP() << "loops are serial in the thread sanitizer's build";
#endif
  if (core_count() < 2) GTEST_SKIP() << "one core";
  std::atomic<int> handed = 0;
  std::vector<std::size_t> order;
  parallel_stages(
      4, [](std::size_t k) { return k < 10; },
      [&](std::size_t k) {
        while (k == 0 && handed < 5) std::this_thread::yield();
      },
      [&](std::size_t k) {
        order.push_back(k);
        ++handed;
      },
      HandOver::as_done);
  ASSERT_EQ(order.size(), 10u);
  EXPECT_NE(order.front(), 0u);
}

TEST(ParallelStages, RethrowExceptions) {
  for (const HandOver how : {HandOver::in_order, HandOver::as_done}) {
    for (const std::string where : {"begins", "work", "hand_over", "nothing"}) {
      const auto fail_in = [&](const std::string& here, std::size_t k) {
        if (here == where && k == 20) throw std::runtime_error(where);
      };
      const auto call = [&] {
        parallel_stages(
            8,
            [&](std::size_t k) {
              fail_in("begins", k);
              return k < 40;
            },
            [&](std::size_t k) { fail_in("work", k); }, [&](std::size_t k) { fail_in("hand_over", k); }, how);
      };
      EXPECT_EQ(thrown_by(call), where);
    }
  }
}

TEST(Parallel, BackgroundLoopsLowerPriority) {
  // In a separate thread, because the thread keeps its lower priority.
  std::jthread([] {
    std::atomic<int> sum = 0;
    on_some_cores(0.5, [&] { parallel_for(100, [&](int i) { sum += i; }); });
    EXPECT_EQ(sum, 4950);
    EXPECT_EQ(getpriority(PRIO_PROCESS, static_cast<id_t>(gettid())), 10);
    EXPECT_EQ(thrown_by([] { on_some_cores(0.0, [] { throw std::runtime_error("thrown"); }); }), "thrown");
  });
}

TEST(Parallel, WithoutHelpersUsesOneThread) {
  const auto alone = without_helpers();
  std::mutex mutex;
  std::set<std::thread::id> threads;
  const auto note = [&] {
    const std::lock_guard lock(mutex);
    threads.insert(std::this_thread::get_id());
  };
  parallel_for(1000, [&](int) { note(); });
  parallel_stages(
      16, [&](std::size_t k) { return k < 100; }, [&](std::size_t) { note(); }, [&](std::size_t) { note(); },
      HandOver::as_done);
  EXPECT_EQ(threads, std::set{std::this_thread::get_id()});
}

TEST(Parallel, CoreCountIsPositive) { EXPECT_GE(core_count(), 1); }

#ifdef __SANITIZE_THREAD__

/// Calling it in two threads races: they wait for each other, but nothing orders their next accesses.
class InjectedRace {
 public:
  void operator()() {
    there_.fetch_add(1, std::memory_order_relaxed);
    while (there_.load(std::memory_order_relaxed) < 2) std::this_thread::yield();
    ++races_;
  }

 private:
  std::atomic<int> there_ = 0;
  int races_ = 0;
};

// Without a report, the sanitizer would see nothing. A report ends the program with code 66.
TEST(ThreadSanitizer, ReportsInjectedRace) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  InjectedRace race;
  const testing::ExitedWithCode reported(66);
  const std::string report = "WARNING: ThreadSanitizer: data race";
  EXPECT_EXIT(parallel_in_frame(64, 1, [&](std::size_t, std::size_t) { race(); }), reported, report);
}

#endif

}  // namespace
}  // namespace binosplat
