// Replaces parallel.cpp in the thread sanitizer's build. TBB is not instrumented, so the sanitizer would miss
// both its synchronisation and races in loops.

#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "base/parallel.h"

namespace binosplat {

namespace {

// Loops may have more threads than cores, so that races can occur. Nested loops use the helpers left.
constexpr int helpers_of_a_loop = 3;
std::atomic<int> free_helpers = 4 * helpers_of_a_loop;
std::atomic<int> loops_alone = 0;

// If this file's counters ordered memory accesses, they would hide races in bodies.
constexpr auto unordered = std::memory_order_relaxed;

bool is_a_helper_free() {
  if (loops_alone > 0) return false;
  if (free_helpers.fetch_sub(1, unordered) > 0) return true;
  free_helpers.fetch_add(1, unordered);
  return false;
}

/// Calls work() on this thread and on up to `most` others. Rethrows the first exception.
void with_helpers(std::size_t most, const std::function<void()>& work) {
  std::mutex mutex;
  std::exception_ptr trouble;
  const auto guarded = [&] {
    try {
      work();
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!trouble) trouble = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> helpers;
    while (helpers.size() < most && helpers.size() < helpers_of_a_loop && is_a_helper_free()) {
      helpers.emplace_back([&] {
        guarded();
        free_helpers.fetch_add(1, unordered);
      });
    }
    guarded();
  }
  if (trouble) std::rethrow_exception(trouble);
}

}  // namespace

void parallel_chunks(std::size_t count, std::size_t chunk,
                     const std::function<void(std::size_t begin, std::size_t end)>& body) {
  if (count == 0) return;
  constexpr std::size_t most_chunks = 64;  // so that each chunk takes some time, as with TBB
  const std::size_t step = std::max(chunk, count / most_chunks);
  std::atomic<std::size_t> next = 0;
  with_helpers((count - 1) / step, [&] {
    try {
      for (std::size_t begin = next.fetch_add(step, unordered); begin < count;
           begin = next.fetch_add(step, unordered))
        body(begin, std::min(begin + step, count));
    } catch (...) {
      next.store(count, unordered);
      throw;
    }
  });
}

void parallel_stages(std::size_t ahead, const std::function<bool(std::size_t k)>& begins,
                     const std::function<void(std::size_t k)>& work,
                     const std::function<void(std::size_t k)>& hand_over, HandOver how) {
  std::mutex beginning, handing_over;
  std::condition_variable handed_over;
  std::size_t next = 0, handed = 0;
  bool ends = false, fails = false;
  const auto begin = [&]() -> std::optional<std::size_t> {
    const std::lock_guard lock(beginning);
    ends = ends || !begins(next);
    if (ends) return std::nullopt;
    return next++;
  };
  const auto finish = [&](std::size_t k) {
    std::unique_lock lock(handing_over);
    handed_over.wait(lock, [&] { return how == HandOver::as_done || handed == k || fails; });
    if (fails) return;
    hand_over(k);
    ++handed;
    handed_over.notify_all();
  };
  const auto fail = [&] {
    {
      const std::lock_guard lock(beginning);
      ends = true;
    }
    const std::lock_guard lock(handing_over);
    fails = true;
    handed_over.notify_all();
  };
  with_helpers(ahead - 1, [&] {
    try {
      while (const auto k = begin()) {
        work(*k);
        finish(*k);
      }
    } catch (...) {
      fail();
      throw;
    }
  });
}

// Ignores the share: there are few helpers.
void on_some_cores(double, const std::function<void()>& body) {
  constexpr int niceness = 10;
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), niceness);
  body();
}

std::shared_ptr<void> without_helpers() {
  ++loops_alone;
  return {nullptr, [](void*) { --loops_alone; }};
}

// Large enough that code which uses a share of the cores still starts threads.
int core_count() { return 16; }

}  // namespace binosplat
