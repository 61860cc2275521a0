#include "lab/bench_results.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/statistics.h"

namespace binosplat::lab {

std::string BenchPoint::chart(const char* before_size) const {
  return fmt::format("{}, {}, {}{}", scene, eyes == 2 ? "both eyes" : "one eye", before_size, size);
}

namespace {

constexpr double found_by_chance = 0.01;  // of pairs of equal times

/// The times of the repeats. Results of before they were kept tell how far the mean is from the outermost.
std::vector<double> repeats_of(const BenchPoint& point) {
  if (!point.repeats_ms.empty() || std::isnan(point.noise_ms))
    return point.repeats_ms.empty() ? std::vector{point.frame_ms} : point.repeats_ms;
  return {point.frame_ms - point.noise_ms, point.frame_ms + point.noise_ms};
}

}  // namespace

bool BenchPoint::has_times() const {
  const std::vector<double> repeats = repeats_of(*this);
  const auto is_time = [](double ms) { return std::isfinite(ms) && ms > 0.0; };
  return is_time(frame_ms) && std::ranges::all_of(repeats, is_time);
}

void TimeNoise::add(const BenchPoint& point) {
  const std::vector<double> repeats = repeats_of(point);
  const double middle = mean(repeats);
  for (const double ms : repeats) squares_ += (ms / middle - 1.0) * (ms / middle - 1.0);
  freedom_ += static_cast<int>(repeats.size()) - 1;
}

double TimeNoise::between(const BenchPoint& a, const BenchPoint& b, std::size_t pairs) const {
  TimeNoise own;
  own.add(a);
  own.add(b);
  const auto count = [](const BenchPoint& of) { return static_cast<double>(repeats_of(of).size()); };
  return student_t(found_by_chance / static_cast<double>(pairs), freedom_) *
         std::max(deviation(), own.deviation()) * std::sqrt(1.0 / count(a) + 1.0 / count(b));
}

std::vector<bool> pareto_front(const std::vector<BenchPoint>& points) {
  std::map<std::string, TimeNoise> charts;
  for (const BenchPoint& point : points) {
    if (point.has_times()) charts[point.chart()].add(point);
  }
  std::vector<bool> front;
  for (const BenchPoint& point : points) {
    const TimeNoise& noise = charts[point.chart()];
    front.push_back(point.has_times() && std::ranges::none_of(points, [&](const BenchPoint& other) {
                      if (!other.has_times() || other.chart() != point.chart()) return false;
                      const double share =
                                       noise.is_known() ? noise.between(point, other, points.size()) : 0.0,
                                   quicker = point.frame_ms - (1.0 + share) * other.frame_ms,
                                   nearer = other.psnr_db() - point.psnr_db();
                      return quicker >= 0 && nearer >= 0 && (quicker > 0 || nearer > 0);
                    }));
  }
  return front;
}

}  // namespace binosplat::lab
