#include "base/worker_pool.h"

#include <algorithm>

#include "base/parallel.h"

namespace binosplat {

WorkerPool::WorkerPool(int threads) {
  for (int k = 0; k < threads; ++k)
    threads_.emplace_back([this](const std::stop_token& stop) { help(stop); });
}

void WorkerPool::run(std::size_t count, std::size_t chunk, const Body& body) {
  if (count == 0) return;
  if (threads_.empty() || count <= chunk || is_called_.exchange(true)) return body(0, count);
  {
    const std::lock_guard lock(mutex_);
    body_ = &body;
    count_ = count;
    chunk_ = chunk;
    next_ = 0;
  }
  changed_.notify_all();
  work(body);
  {
    std::unique_lock lock(mutex_);
    body_ = nullptr;  // none begins any more
    changed_.wait(lock, [&] { return helping_ == 0; });
  }
  is_called_ = false;
}

void WorkerPool::help(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [&] { return body_ != nullptr && next_ < count_; })) {
    ++helping_;
    const Body& body = *body_;
    lock.unlock();
    work(body);
    lock.lock();
    if (--helping_ == 0) changed_.notify_all();
  }
}

// Nothing is handed over from chunk to chunk: relaxed, so that the thread sanitizer sees where bodies do.
void WorkerPool::work(const Body& body) {
  const auto next = [&] { return next_.fetch_add(chunk_, std::memory_order_relaxed); };
  for (std::size_t begin = next(); begin < count_; begin = next())
    body(begin, std::min(begin + chunk_, count_));
}

void frame_chunks(std::size_t count, std::size_t chunk, const WorkerPool::Body& body) {
  static WorkerPool pool(core_count() / 4 - 1);
  pool.run(count, chunk, body);
}

}  // namespace binosplat
