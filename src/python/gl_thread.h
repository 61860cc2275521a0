#pragma once
// A thread of its own for an OpenGL context. A context is current on one thread; Python calls from any, and
// collects garbage on any. And a context of the caller's, current on the caller's thread, stays so.

#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "python/unlocked.h"

namespace binosplat::python {

class GlThread {
 public:
  /// Throws Error in a process that was forked from one with such a thread, as every call does: threads and
  /// OpenGL drivers do not survive that.
  GlThread();
  /// Not in a process that was forked from this one: there is no thread to wait for, so leave it alone.
  ~GlThread();
  GlThread(const GlThread&) = delete;
  GlThread& operator=(const GlThread&) = delete;

  /// Whether this is the process that the first of these threads was started in.
  static bool in_its_process();

  /// Has the thread call `work` after what it was given before, and returns at once. The result may be
  /// dropped, so `work` must refer to nothing of the caller's; nor may it need Python's lock.
  template <typename Work>
  auto start(Work work) -> std::future<decltype(work())> {
    check_process();
    // Shared, because the caller may have the result before the thread is out of the call.
    const auto task = std::make_shared<std::packaged_task<decltype(work())()>>(std::move(work));
    auto result = task->get_future();
    hand_over([task, lives = std::make_shared<const Outlived>()] { (*task)(); });
    return result;
  }

  /// The same, and waits: returns or throws what `work` does.
  template <typename Work>
  auto run(Work work) -> decltype(work()) {
    return start(std::move(work)).get();
  }

  /// Whether it has work that is not done.
  bool is_busy();

 private:
  static void check_process();
  void hand_over(std::function<void()> job);
  void loop();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> jobs_;  // the first one is under way
  bool ended_ = false;
  std::thread thread_;
};

}  // namespace binosplat::python
