#include "base/job_queue.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/parallel.h"

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
      changed_.wait(lock, [&] { return turn_ == job.turn; });  // ends: earlier jobs have started
      run(lock, job.then);
      ++turn_;
      changed_.notify_all();
    }
    lock.unlock();
    job = {};  // destroy the job's captures before it counts as done
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

void JobQueue::share(std::size_t count, std::size_t chunk, const Body& body) {
  if (threads_.empty() || count <= chunk || is_sharing_.exchange(true)) return body(0, count);
  // Chunks share no data. A stronger order would hide races in bodies from the thread sanitizer.
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    const auto take = [&] { return next.fetch_add(chunk, std::memory_order_relaxed); };
    for (std::size_t begin = take(); begin < count; begin = take())
      body(begin, std::min(begin + chunk, count));
  };
  for (std::size_t k = 0; k < std::min(threads_.size(), (count - 1) / chunk); ++k) add(work);
  work();
  finish();
  is_sharing_ = false;
}

void frame_chunks(std::size_t count, std::size_t chunk, const JobQueue::Body& body) {
  static JobQueue queue(core_count() / 4 - 1, std::numeric_limits<std::size_t>::max());
  queue.share(count, chunk, body);
}

}  // namespace binosplat
