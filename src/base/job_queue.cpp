#include "base/job_queue.h"

#include <utility>

namespace binosplat {

JobQueue::JobQueue(int threads, std::size_t waiting_max) : waiting_max_(waiting_max) {
  for (int k = 0; k < threads; ++k)
    threads_.emplace_back([this](const std::stop_token& stop) { work(stop); });
}

void JobQueue::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [&] { return !waiting_.empty(); }) && !stop.stop_requested()) {
    std::function<void()> job = std::move(waiting_.front());
    waiting_.pop_front();
    ++running_;
    changed_.notify_all();
    lock.unlock();
    std::exception_ptr failure;
    try {
      job();
    } catch (...) {
      failure = std::current_exception();
    }
    job = nullptr;  // what it holds goes before it counts as done
    lock.lock();
    --running_;
    if (failure && !failure_) failure_ = failure;
    if (failure_) waiting_.clear();
    changed_.notify_all();
  }
}

void JobQueue::add(std::function<void()> job) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return waiting_.size() < waiting_max_ || failure_; });
  if (failure_) std::rethrow_exception(failure_);
  waiting_.push_back(std::move(job));
  changed_.notify_all();
}

void JobQueue::finish() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return waiting_.empty() && running_ == 0; });
  if (failure_) std::rethrow_exception(failure_);
}

}  // namespace binosplat
