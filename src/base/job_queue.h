#pragma once
// Threads of their own: they work while the caller goes on, as pictures are encoded and written while the
// next ones are drawn, or share a frame's copying with it.

#include <atomic>
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

  /// Calls body(begin, end) for chunks of `chunk` at most that make up [0, count), on this thread and the
  /// queue's; on this thread alone while another one shares. `body` must not throw.
  using Body = std::function<void(std::size_t begin, std::size_t end)>;
  void share(std::size_t count, std::size_t chunk, const Body& body);

 private:
  struct Job {
    std::function<void()> work, then;
    std::size_t turn = 0;  // of `then`
  };
  void work(const std::stop_token& stop);
  void run(std::unique_lock<std::mutex>& lock, const std::function<void()>& part);

  std::size_t waiting_max_;
  std::atomic<bool> is_sharing_ = false;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Job> waiting_;
  std::size_t running_ = 0;
  std::size_t turns_ = 0, turn_ = 0;   // handed out, and whose it is
  std::exception_ptr failure_;         // of the job that failed first
  std::vector<std::jthread> threads_;  // last: they end first
};

/// JobQueue::share of one queue for all frames, which has a quarter of the cores with this one. The threads
/// of parallel_chunks may be others' for some ms, and give way to others once they worked in the background:
/// a frame that waits for them has no time for that.
void frame_chunks(std::size_t count, std::size_t chunk, const JobQueue::Body& body);

/// Numbers of 4 bytes to copy that are worth a thread's while: some 20 us.
inline constexpr std::size_t frame_chunk_numbers = std::size_t{1} << 15;

}  // namespace binosplat
