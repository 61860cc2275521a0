// Replaces parallel.cpp in the thread sanitizer's build: every loop runs on its calling thread. TBB is not
// instrumented, so the sanitizer would report false races. It checks the program's own threads.

#include <sys/resource.h>
#include <unistd.h>

#include "base/parallel.h"

namespace binosplat {

void parallel_chunks(std::size_t count, std::size_t,
                     const std::function<void(std::size_t begin, std::size_t end)>& body) {
  if (count > 0) body(0, count);
}

void parallel_stages(std::size_t, const std::function<bool(std::size_t k)>& begins,
                     const std::function<void(std::size_t k)>& work,
                     const std::function<void(std::size_t k)>& hand_over, HandOver) {
  for (std::size_t k = 0; begins(k); ++k) {
    work(k);
    hand_over(k);
  }
}

void on_some_cores(double, const std::function<void()>& body) {
  constexpr int niceness = 10;
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), niceness);
  body();
}

std::shared_ptr<void> without_helpers() { return nullptr; }

// Large enough that code which uses a share of the cores still starts threads.
int core_count() { return 16; }

}  // namespace binosplat
