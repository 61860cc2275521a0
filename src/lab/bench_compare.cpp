#include "lab/bench_compare.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace binosplat::lab {

namespace {

constexpr double least_share = 0.02;  // that a frame time must change by

/// Points of two runs are the same by this.
std::pair<std::string, NamedSettings> identity(const BenchPoint& point) {
  return {point.chart(), point.settings};
}

/// A point in both runs.
struct BothRuns {
  const BenchPoint* was;
  const BenchPoint* is;
};

}  // namespace

BenchComparison compare_results(const std::vector<BenchPoint>& before, const std::vector<BenchPoint>& now) {
  std::map<std::pair<std::string, NamedSettings>, const BenchPoint*> old;
  for (const BenchPoint& point : before) {
    if (point.is_there()) old[identity(point)] = &point;
  }
  std::vector<BothRuns> both;
  BenchComparison result;
  TimeNoise noise_of_all;
  for (const BenchPoint& point : now) {
    const auto found = old.find(identity(point));
    if (!point.is_there() || found == old.end()) continue;
    ++result.matched;
    if (point.has_times() && found->second->has_times()) {
      both.push_back({found->second, &point});
      noise_of_all.add(*found->second);
      noise_of_all.add(point);
    } else {
      result.lines.push_back(
          fmt::format("{}, {}: its times cannot be compared: expected numbers above 0, and "
                      "{} run has others or none; measure it again",
                      point.chart(""), point.name, point.has_times() ? "the older" : "this"));
    }
  }
  const std::size_t broken = result.lines.size();
  result.timed = noise_of_all.is_known() ? both.size() : 0;
  for (const BothRuns& one : both) {
    const BenchPoint &was = *one.was, &point = *one.is;
    const std::string name = fmt::format("{}, {}", point.chart(""), point.name);
    std::string line;
    const auto tell = [&](const std::string& text) { line += (line.empty() ? "" : "; ") + text; };
    const double change = point.frame_ms / was.frame_ms - 1.0;
    const double noise = noise_of_all.is_known() ? noise_of_all.between(was, point, both.size()) : INFINITY;
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
  const auto measured = std::count_if(now.begin(), now.end(), [](const auto& p) { return p.is_there(); });
  result.lines.push_back(
      fmt::format("{} of {} points in both runs changed beyond noise; {} are new, {} are gone{}",
                  result.lines.size() - broken, both.size(),
                  measured - static_cast<std::ptrdiff_t>(result.matched), old.size() - result.matched,
                  !noise_of_all.is_known() && !both.empty()
                      ? ". Times were not compared: with one repeat a point nothing tells their noise"
                      : ""));
  return result;
}

}  // namespace binosplat::lab
