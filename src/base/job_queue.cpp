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
    Job job = std::move(waiting_.front());
    waiting_.pop_front();
    ++running_;
    changed_.notify_all();
    run(lock, job.work);
    if (job.then) {
      changed_.wait(lock, [&] { return turn_ == job.turn; });  // jobs before it have begun, and will end
      run(lock, job.then);
      ++turn_;
      changed_.notify_all();
    }
    lock.unlock();
    job = {};  // what it holds goes before it counts as done
    lock.lock();
    --running_;
    changed_.notify_all();
  }
}

void JobQueue::run(std::unique_lock<std::mutex>& lock, const std::function<void()>& part) {
  if (failure_) return;
  lock.unlock();
  std::exception_ptr failure;
  try {
    part();
  } catch (...) {
    failure = std::current_exception();
  }
  lock.lock();
  if (failure && !failure_) failure_ = failure;
  if (failure_) waiting_.clear();
  changed_.notify_all();
}

void JobQueue::add(std::function<void()> job, std::function<void()> then) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return waiting_.size() < waiting_max_ || failure_; });
  if (failure_) std::rethrow_exception(failure_);
  waiting_.push_back({std::move(job), std::move(then), turns_});
  if (waiting_.back().then) ++turns_;
  changed_.notify_all();
}

void JobQueue::finish() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return waiting_.empty() && running_ == 0; });
  if (failure_) std::rethrow_exception(failure_);
}

}  // namespace binosplat
