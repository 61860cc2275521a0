#pragma once
// What changed between two runs of bench.

#include <string>
#include <vector>

#include "lab/bench_results.h"

namespace binosplat::lab {

struct BenchComparison {
  std::vector<std::string> lines;  // of points whose times are none, of those that changed beyond noise; the
                                   // last one counts
  std::size_t matched = 0;         // points of both runs
  std::size_t timed = 0;           // of these: whose times were compared
  double slower_percent = 0.0;     // of the point that became slower by most, beyond noise; 0: none did
  std::string slowest;             // that point
};

/// Points are matched by scene, eyes, size and settings. A frame time has changed when it differs by more
/// than 2 %, and by more than the repeats of both runs scatter: then one pair of equal runs in a hundred
/// finds a change (Student's t of their repeats' relative scatter, over all points together, or of the
/// point's own where that is larger). PSNR has changed when it differs by 0.01 dB; pairs by 0.1 %. Times of
/// points with one repeat are not compared, since nothing tells their noise.
BenchComparison compare_results(const std::vector<BenchPoint>& before, const std::vector<BenchPoint>& now);

}  // namespace binosplat::lab
