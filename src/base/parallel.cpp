#include "base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace binosplat {

void parallel_chunks(std::size_t count, std::size_t chunk,
                     const std::function<void(std::size_t begin, std::size_t end)>& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, chunk),
                    [&](const tbb::blocked_range<std::size_t>& range) { body(range.begin(), range.end()); });
}

void on_some_cores(double share, const std::function<void()>& body) {
  tbb::task_arena arena(std::max(1, static_cast<int>(share * tbb::this_task_arena::max_concurrency())));
  arena.execute(body);
}

}  // namespace binosplat
