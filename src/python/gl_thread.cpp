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
        "processes "
        "by multiprocessing's method 'spawn'");
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
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !job_; });
    job_ = std::move(job);
  }
  changed_.notify_all();
}

void GlThread::loop() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return job_ || ended_; });
    if (!job_) return;
    lock.unlock();
    job_();  // what it throws, its future keeps
    lock.lock();
    job_ = nullptr;
    changed_.notify_all();
  }
}

}  // namespace binosplat::python
