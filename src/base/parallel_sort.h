#pragma once
// Parallel sorting on all cores.

// The thread sanitizer's build sorts without TBB. TBB is not instrumented, so the sanitizer would miss races
// and report false ones.
#ifdef __SANITIZE_THREAD__
#include <algorithm>
#else
#include <tbb/parallel_sort.h>
#endif

#include <functional>

namespace binosplat {

/// Sorts [begin, end). The order of equal elements is unspecified.
template <typename Iterator, typename Less = std::less<>>
void parallel_sort(Iterator begin, Iterator end, const Less& less = {}) {
#ifdef __SANITIZE_THREAD__
  std::sort(begin, end, less);
#else
  tbb::parallel_sort(begin, end, less);
#endif
}

}  // namespace binosplat
