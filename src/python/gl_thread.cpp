#include "python/gl_thread.h"

#include <unistd.h>

#include <utility>

#include "base/error.h"

namespace binosplat::python {

bool GlThread::in_its_process() {
  static const pid_t process = getpid();
  return getpid() == process;
}

void GlThread::check_process() {
  if (!in_its_process()) {
    fail(
        "a Renderer was opened before this process was forked, which OpenGL does not survive: start "
        "processes by multiprocessing's method 'spawn'");
  }
}

GlThread::GlThread() {
  check_process();
  thread_ = std::thread([this] { loop(); });
}

GlThread::~GlThread() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void GlThread::hand_over(std::function<void()> job) {
  {
    const std::lock_guard lock(mutex_);
    jobs_.push_back(std::move(job));
  }
  changed_.notify_all();
}

bool GlThread::is_busy() {
  const std::lock_guard lock(mutex_);
  return !jobs_.empty();
}

void GlThread::loop() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return !jobs_.empty() || ended_; });
    if (jobs_.empty()) return;
    {
      const std::function<void()>& job = jobs_.front();
      lock.unlock();
      job();  // its future stores exceptions
      lock.lock();
    }
    jobs_.pop_front();
  }
}

}  // namespace binosplat::python
