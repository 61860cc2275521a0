#pragma once
// Sorting on all cores.

#ifdef __SANITIZE_THREAD__  // which would see nothing of ours in TBB's sort, and takes what TBB does for
                            // races
#include <algorithm>
#else
#include <tbb/parallel_sort.h>
#endif

#include <functional>

namespace binosplat {

/// Sorts [begin, end). Equal ones are in any order.
template <typename Iterator, typename Less = std::less<>>
void parallel_sort(Iterator begin, Iterator end, const Less& less = {}) {
#ifdef __SANITIZE_THREAD__
  std::sort(begin, end, less);
#else
  tbb::parallel_sort(begin, end, less);
#endif
}

}  // namespace binosplat
