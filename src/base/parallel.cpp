// Implements parallel.h with TBB. Only this file and parallel_sort.h include TBB.

#include "base/parallel.h"

#include <sys/resource.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
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

void parallel_stages(std::size_t ahead, const std::function<bool(std::size_t k)>& begins,
                     const std::function<void(std::size_t k)>& work,
                     const std::function<void(std::size_t k)>& hand_over, HandOver how) {
  std::size_t next = 0;
  const auto begin = [&](tbb::flow_control& control) -> std::size_t {
    if (begins(next)) return next++;
    control.stop();
    return 0;
  };
  const auto worked = [&](std::size_t k) {
    work(k);
    return k;
  };
  using tbb::filter_mode;
  const auto mode =
      how == HandOver::in_order ? filter_mode::serial_in_order : filter_mode::serial_out_of_order;
  tbb::parallel_pipeline(ahead,
                         tbb::make_filter<void, std::size_t>(filter_mode::serial_in_order, begin) &
                             tbb::make_filter<std::size_t, std::size_t>(filter_mode::parallel, worked) &
                             tbb::make_filter<std::size_t, void>(mode, hand_over));
}

namespace {

/// Lowers the priority of threads that help in the background, in favour of frames. The low priority stays,
/// because raising it needs a privilege.
class LowPriority : tbb::task_scheduler_observer {
 public:
  explicit LowPriority(tbb::task_arena& arena) : tbb::task_scheduler_observer(arena) { observe(true); }
  ~LowPriority() override { observe(false); }

 private:
  void on_scheduler_entry(bool) override { setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), niceness); }

  static constexpr int niceness = 10;
};

}  // namespace

void on_some_cores(double share, const std::function<void()>& body) {
  tbb::task_arena arena(std::max(1, static_cast<int>(share * tbb::this_task_arena::max_concurrency())));
  const LowPriority low_priority(arena);
  arena.execute(body);
}

std::shared_ptr<void> without_helpers() {
  return std::make_shared<tbb::global_control>(tbb::global_control::max_allowed_parallelism, 1);
}

int core_count() { return tbb::info::default_concurrency(); }

}  // namespace binosplat
