#include "base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace binosplat {

void parallel_chunks(std::size_t count, std::size_t chunk,
                     const std::function<void(std::size_t begin, std::size_t end)>& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, chunk),
                    [&](const tbb::blocked_range<std::size_t>& range) { body(range.begin(), range.end()); });
}

}  // namespace binosplat
