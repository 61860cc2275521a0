#include "base/parallel.h"

#include <sys/resource.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_scheduler_observer.h>
#include <unistd.h>

#include <algorithm>

namespace binosplat {

void parallel_chunks(std::size_t count, std::size_t chunk,
                     const std::function<void(std::size_t begin, std::size_t end)>& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, chunk),
                    [&](const tbb::blocked_range<std::size_t>& range) { body(range.begin(), range.end()); });
}

namespace {

/// Threads that help others in the background give way to frames, and do so from then on: back needs a
/// privilege.
class GivesWay : tbb::task_scheduler_observer {
 public:
  explicit GivesWay(tbb::task_arena& arena) : tbb::task_scheduler_observer(arena) { observe(true); }
  ~GivesWay() override { observe(false); }

 private:
  void on_scheduler_entry(bool) override { setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), niceness); }

  static constexpr int niceness = 10;
};

}  // namespace

void on_some_cores(double share, const std::function<void()>& body) {
  tbb::task_arena arena(std::max(1, static_cast<int>(share * tbb::this_task_arena::max_concurrency())));
  const GivesWay gives_way(arena);
  arena.execute(body);
}

}  // namespace binosplat
