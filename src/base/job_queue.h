#pragma once
// Work that threads of its own do while the caller goes on: pictures are encoded and written so while the
// next ones are drawn.

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace binosplat {

class JobQueue {
 public:
  /// That many threads; at most `waiting_max` jobs wait for one.
  JobQueue(int threads, std::size_t waiting_max);
  /// Waits for jobs that have begun; the others are left out.
  ~JobQueue() = default;
  JobQueue(const JobQueue&) = delete;
  JobQueue& operator=(const JobQueue&) = delete;

  /// Waits while as many jobs wait as may. Once a job has thrown, no other begins, and this throws that.
  void add(std::function<void()> job);

  /// Waits until all jobs are done. Throws as add() does.
  void finish();

 private:
  void work(const std::stop_token& stop);

  std::size_t waiting_max_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<std::function<void()>> waiting_;
  std::size_t running_ = 0;
  std::exception_ptr failure_;         // of the job that failed first
  std::vector<std::jthread> threads_;  // last: they end first
};

}  // namespace binosplat
