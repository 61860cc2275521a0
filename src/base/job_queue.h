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

  /// Waits while as many jobs wait as may. `then` is called when the job is done: one at a time, in the order
  /// in which jobs were added. Once a job or a `then` has thrown, no other begins, and this throws that.
  void add(std::function<void()> job, std::function<void()> then = {});

  /// Waits until all jobs are done. Throws as add() does.
  void finish();

 private:
  struct Job {
    std::function<void()> work, then;
    std::size_t turn = 0;  // of `then`
  };
  void work(const std::stop_token& stop);
  void run(std::unique_lock<std::mutex>& lock, const std::function<void()>& part);

  std::size_t waiting_max_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Job> waiting_;
  std::size_t running_ = 0;
  std::size_t turns_ = 0, turn_ = 0;   // handed out, and whose it is
  std::exception_ptr failure_;         // of the job that failed first
  std::vector<std::jthread> threads_;  // last: they end first
};

}  // namespace binosplat
