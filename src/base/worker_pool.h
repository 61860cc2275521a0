#pragma once
// Copying within a frame, on several cores.

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace binosplat {

/// Threads that work for frames only. Those of parallel_chunks may be others' for some ms, and have given
/// way to others once they worked in the background: a frame that waits for them has no time for that.
class WorkerPool {
 public:
  /// That many beside the thread that calls.
  explicit WorkerPool(int threads);
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// Calls body(begin, end) for chunks of `chunk` at most that make up [0, count), by this thread and those
  /// that are free, or by this one alone while another call is at work. `body` must not throw.
  using Body = std::function<void(std::size_t begin, std::size_t end)>;
  void run(std::size_t count, std::size_t chunk, const Body& body);

 private:
  void help(const std::stop_token& stop);
  void work(const Body& body);

  std::atomic<bool> is_called_ = false;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  const Body* body_ = nullptr;
  std::size_t count_ = 0, chunk_ = 1;
  std::atomic<std::size_t> next_ = 0;
  int helping_ = 0;
  std::vector<std::jthread> threads_;  // last: they end first
};

/// By one pool for all frames, of a quarter of the cores with the one that calls.
void frame_chunks(std::size_t count, std::size_t chunk, const WorkerPool::Body& body);

/// Numbers of 4 bytes to copy that are worth a thread's while: some 20 us.
inline constexpr std::size_t frame_chunk_numbers = std::size_t{1} << 15;

}  // namespace binosplat
