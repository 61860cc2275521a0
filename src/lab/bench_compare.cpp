#include "lab/bench_compare.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/statistics.h"

namespace binosplat::lab {

namespace {

constexpr double found_by_chance = 0.01;  // of pairs of equal runs
constexpr double least_share = 0.02;      // that a frame time must change by

/// Points of two runs are the same by this.
std::pair<std::string, NamedSettings> identity(const BenchPoint& point) {
  return {point.chart(), point.settings};
}

/// A point in both runs.
struct BothRuns {
  const BenchPoint* was;
  const BenchPoint* is;
};

/// The times of the repeats. Results of before they were kept tell how far the mean is from the outermost.
std::vector<double> repeats_of(const BenchPoint& point) {
  if (!point.repeats_ms.empty() || std::isnan(point.noise_ms))
    return point.repeats_ms.empty() ? std::vector{point.frame_ms} : point.repeats_ms;
  return {point.frame_ms - point.noise_ms, point.frame_ms + point.noise_ms};
}

/// How repeats scatter around their means, relative to these.
struct Scatter {
  double squares = 0.0;
  int freedom = 0;

  void add(const BenchPoint& point) {
    const std::vector<double> repeats = repeats_of(point);
    const double middle = mean(repeats);
    for (const double ms : repeats) squares += (ms / middle - 1.0) * (ms / middle - 1.0);
    freedom += static_cast<int>(repeats.size()) - 1;
  }
  double deviation() const { return freedom > 0 ? std::sqrt(squares / freedom) : 0.0; }
};

/// By how much a time may differ without having changed, relative to what it was.
double noise_of(const BothRuns& point, const Scatter& all, std::size_t points) {
  Scatter own;
  own.add(*point.was);
  own.add(*point.is);
  const auto count = [](const BenchPoint& of) { return static_cast<double>(repeats_of(of).size()); };
  const double t = student_t(found_by_chance / static_cast<double>(points), all.freedom);
  return t * std::max(all.deviation(), own.deviation()) *
         std::sqrt(1.0 / count(*point.was) + 1.0 / count(*point.is));
}

}  // namespace

BenchComparison compare_results(const std::vector<BenchPoint>& before, const std::vector<BenchPoint>& now) {
  std::map<std::pair<std::string, NamedSettings>, const BenchPoint*> old;
  for (const BenchPoint& point : before) {
    if (point.measured()) old[identity(point)] = &point;
  }
  std::vector<BothRuns> both;
  Scatter all;
  for (const BenchPoint& point : now) {
    const auto found = old.find(identity(point));
    if (!point.measured() || found == old.end()) continue;
    both.push_back({found->second, &point});
    all.add(*found->second);
    all.add(point);
  }
  BenchComparison result{.matched = both.size()};
  for (const BothRuns& one : both) {
    const BenchPoint &was = *one.was, &point = *one.is;
    const std::string name = fmt::format("{}, {}", point.chart(""), point.name);
    std::string line;
    const auto tell = [&](const std::string& text) { line += (line.empty() ? "" : "; ") + text; };
    const double change = point.frame_ms / was.frame_ms - 1.0;
    const double noise = all.freedom == 0 ? INFINITY : noise_of(one, all, both.size());
    if (std::abs(change) > std::max(noise, least_share)) {
      tell(fmt::format("{:.3f} ms -> {:.3f} ms ({:+.1f} %, noise {:.1f} %)", was.frame_ms, point.frame_ms,
                       100.0 * change, 100.0 * noise));
      if (100.0 * change > result.slower_percent) {
        result.slower_percent = 100.0 * change;
        result.slowest = name;
      }
    }
    if (std::abs(point.psnr_db() - was.psnr_db()) > 0.01)
      tell(fmt::format("{:.2f} dB -> {:.2f} dB", was.psnr_db(), point.psnr_db()));
    if (std::abs(point.pairs - was.pairs) > 1e-3 * was.pairs)
      tell(fmt::format("{:.0f} pairs -> {:.0f}", was.pairs, point.pairs));
    if (!line.empty()) result.lines.push_back(name + ": " + line);
  }
  const auto measured = std::count_if(now.begin(), now.end(), [](const auto& p) { return p.measured(); });
  result.lines.push_back(fmt::format(
      "{} of {} points in both runs changed beyond noise; {} are new, {} are gone{}", result.lines.size(),
      both.size(), measured - static_cast<std::ptrdiff_t>(both.size()), old.size() - both.size(),
      all.freedom == 0 && !both.empty()
          ? ". Times were not compared: with one repeat a point nothing tells their noise"
          : ""));
  return result;
}

}  // namespace binosplat::lab
