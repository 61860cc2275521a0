#pragma once
// A thread that owns an OpenGL context, because Python may call functions and collect garbage on any thread.
// A context that the caller made current on its own thread stays current.

#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "python/released_gil.h"

namespace binosplat::python {

class GlThread {
 public:
  /// The constructor and all calls throw Error in a process that was forked after a GlThread started, because
  /// threads and OpenGL drivers do not survive a fork.
  GlThread();
  /// Do not destroy a GlThread in a forked process, where the thread to join does not exist.
  ~GlThread();
  GlThread(const GlThread&) = delete;
  GlThread& operator=(const GlThread&) = delete;

  /// Whether this process started the first of these threads.
  static bool in_its_process();

  /// Queues `work` for the thread and returns at once. The caller may drop the result, so `work` must not
  /// refer to the caller's objects. `work` must not need Python's lock.
  template <typename Work>
  auto start(Work work) -> std::future<decltype(work())> {
    check_process();
    // Shared, because the caller may have the result before the thread leaves the call.
    const auto task = std::make_shared<std::packaged_task<decltype(work())()>>(std::move(work));
    auto result = task->get_future();
    hand_over([task, lives = std::make_shared<const ProcessKeepAlive>()] { (*task)(); });
    return result;
  }

  template <typename Work>
  auto run(Work work) -> decltype(work()) {
    return start(std::move(work)).get();
  }

  /// Whether work is queued or running.
  bool is_busy();

 private:
  static void check_process();
  void hand_over(std::function<void()> job);
  void loop();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> jobs_;  // the first one is running
  bool ended_ = false;
  std::thread thread_;
};

}  // namespace binosplat::python
