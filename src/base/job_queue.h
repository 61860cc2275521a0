#pragma once
// A queue of jobs with its own threads: they encode pictures while the caller draws, or help to copy a frame.

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
  JobQueue(int threads, std::size_t waiting_max);
  /// Waits for running jobs and drops the others.
  ~JobQueue() = default;
  JobQueue(const JobQueue&) = delete;
  JobQueue& operator=(const JobQueue&) = delete;

  /// Waits for room and adds a job. Calls of `then` follow their jobs, one at a time, in the order of add().
  /// After an exception no job or `then` starts, and add() rethrows the exception.
  void add(std::function<void()> job, std::function<void()> then = {});

  /// Waits for all jobs. Rethrows exceptions as add() does.
  void finish();

  /// Covers [0, count) by calls of body(begin, end), each of at most `chunk` indices, on this thread and the
  /// queue's. Without threads, or during another share(), calls body(0, count). `body` must not throw.
  using Body = std::function<void(std::size_t begin, std::size_t end)>;
  void share(std::size_t count, std::size_t chunk, const Body& body);

 private:
  struct Job {
    std::function<void()> work, then;
    std::size_t turn = 0;  // number of earlier jobs that have a `then`
  };
  void work(const std::stop_token& stop);
  void run(std::unique_lock<std::mutex>& lock, const std::function<void()>& part);

  std::size_t waiting_max_;
  std::atomic<bool> is_sharing_ = false;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Job> waiting_;
  std::size_t running_ = 0;
  std::size_t turns_ = 0, turn_ = 0;   // number of turns assigned, and the current turn
  std::exception_ptr failure_;         // thrown by the first failed job
  std::vector<std::jthread> threads_;  // the last member: its destructor runs first and joins the threads
};

/// Divides a frame's work among a quarter of the cores. parallel_chunks() does not suit frames: its threads
/// may be busy for some ms, and keep a low priority after background work.
void frame_chunks(std::size_t count, std::size_t chunk, const JobQueue::Body& body);

/// The `chunk` of frame_chunks() for copying 4-byte numbers. Copying this many numbers takes about 20 us.
inline constexpr std::size_t frame_chunk_numbers = std::size_t{1} << 15;

}  // namespace binosplat
