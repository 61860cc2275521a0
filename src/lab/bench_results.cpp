#include "lab/bench_results.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace binosplat::lab {

std::string BenchPoint::chart(const char* before_size) const {
  return fmt::format("{}, {}, {}{}", scene, eyes == 2 ? "both eyes" : "one eye", before_size, size);
}

std::vector<bool> pareto_front(const std::vector<BenchPoint>& points) {
  std::vector<bool> front;
  for (const BenchPoint& point : points) {
    front.push_back(point.measured() && std::none_of(points.begin(), points.end(), [&](const auto& other) {
                      if (!other.measured() || other.chart() != point.chart()) return false;
                      const double quicker = point.frame_ms - other.frame_ms,
                                   nearer = other.psnr_db() - point.psnr_db();
                      return quicker >= 0 && nearer >= 0 && (quicker > 0 || nearer > 0);
                    }));
  }
  return front;
}

}  // namespace binosplat::lab
