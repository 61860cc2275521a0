#include "base/parallel_in_frame.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include "base/parallel.h"

namespace binosplat {

void parallel_in_frame(std::size_t count, std::size_t chunk,
                       const std::function<void(std::size_t begin, std::size_t end)>& body) {
  // Chunks share no data. A stronger order would hide races in bodies from the thread sanitizer.
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    const auto take = [&] { return next.fetch_add(chunk, std::memory_order_relaxed); };
    for (std::size_t begin = take(); begin < count; begin = take())
      body(begin, std::min(begin + chunk, count));
  };
  // A thread takes as long to start as a few chunks of numbers_a_chunk take to copy.
  const std::size_t threads = std::min<std::size_t>(core_count() / 4, 1 + count / (8 * chunk));
  std::vector<std::jthread> others;
  for (std::size_t k = 1; k < threads; ++k) others.emplace_back(work);
  work();
}

}  // namespace binosplat
