#include "lab/bench_results.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace binosplat::lab {

namespace {

/// Points of two runs are the same by this.
std::pair<std::string, NamedSettings> identity(const BenchPoint& point) {
  return {point.chart(), point.settings};
}

}  // namespace

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

std::vector<std::string> compare_results(const std::vector<BenchPoint>& before,
                                         const std::vector<BenchPoint>& now) {
  std::map<std::pair<std::string, NamedSettings>, const BenchPoint*> old;
  for (const BenchPoint& point : before) {
    if (point.measured()) old[identity(point)] = &point;
  }
  std::vector<std::string> lines;
  int matched = 0, changed = 0;
  for (const BenchPoint& point : now) {
    const auto found = old.find(identity(point));
    if (!point.measured() || found == old.end()) continue;
    ++matched;
    const BenchPoint& was = *found->second;
    std::string line;
    const auto tell = [&](const std::string& text) { line += (line.empty() ? "" : "; ") + text; };
    const auto noise = [](const BenchPoint& p) { return std::isnan(p.noise_ms) ? 0.0 : p.noise_ms; };
    const double ms = point.frame_ms, old_ms = was.frame_ms;
    if (std::abs(ms - old_ms) > std::max(noise(point) + noise(was), 0.02 * old_ms))
      tell(fmt::format("{:.3f} ms -> {:.3f} ms ({:+.1f} %)", old_ms, ms, 100 * (ms / old_ms - 1)));
    if (std::abs(point.psnr_db() - was.psnr_db()) > 0.01)
      tell(fmt::format("{:.2f} dB -> {:.2f} dB", was.psnr_db(), point.psnr_db()));
    if (std::abs(point.pairs - was.pairs) > 1e-3 * was.pairs)
      tell(fmt::format("{:.0f} pairs -> {:.0f}", was.pairs, point.pairs));
    if (line.empty()) continue;
    ++changed;
    lines.push_back(fmt::format("{}, {}: {}", point.chart(""), point.name, line));
  }
  const auto measured = std::count_if(now.begin(), now.end(), [](const auto& p) { return p.measured(); });
  lines.push_back(fmt::format("{} of {} points in both runs changed beyond noise; {} are new, {} are gone",
                              changed, matched, measured - matched, static_cast<int>(old.size()) - matched));
  return lines;
}

}  // namespace binosplat::lab
