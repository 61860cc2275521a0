#include "formats/detail.h"

#include <algorithm>
#include <cmath>
#include <queue>

namespace binosplat {

namespace {

/// By how much a level must be too coarse, or finer than need be, before it is left: heads are never still.
constexpr double inertia = 1.1;

/// From the nearest eye to the box, at least a hundredth of its diagonal: 0 within it would hide how coarse
/// its Gaussians are. 1 without eyes.
double distance_to(const DetailPart& part, const std::vector<glm::dvec3>& eyes) {
  if (eyes.empty()) return 1.0;
  double nearest = INFINITY;
  for (const glm::dvec3& eye : eyes)
    nearest = std::min(nearest, glm::distance(eye, glm::clamp(eye, part.low, part.high)));
  return std::max(nearest, 0.01 * glm::distance(part.low, part.high));
}

}  // namespace

std::vector<std::size_t> choose_levels(const std::vector<DetailPart>& parts,
                                       const std::vector<glm::dvec3>& eyes, std::size_t most, double enough,
                                       std::span<const std::size_t> before) {
  struct Coarse {
    double apart;  // of its Gaussians, as seen, radians
    std::size_t part;
    bool operator<(const Coarse& other) const { return apart < other.apart; }
  };
  std::vector<std::size_t> chosen(parts.size(), 0);
  std::priority_queue<Coarse> coarse;
  std::size_t total = 0;
  const auto add = [&](std::size_t p) {
    const DetailPart& part = parts[p];
    if (chosen[p] == 0) return;  // the finest
    const auto count = static_cast<double>(std::max<std::size_t>(part.levels[chosen[p]].count, 1));
    const double diagonal = glm::distance(part.low, part.high);
    const double stays = before.empty() ? 1.0 : chosen[p] > before[p] ? inertia : 1.0 / inertia;
    const double apart = stays * diagonal / std::sqrt(count) / distance_to(part, eyes);
    if (apart > enough) coarse.push({apart, p});
  };
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (parts[p].levels.empty()) continue;
    chosen[p] = parts[p].levels.size() - 1;
    total += parts[p].levels.back().count;
    add(p);
  }
  while (!coarse.empty()) {
    const std::size_t p = coarse.top().part;
    coarse.pop();
    const std::size_t now = parts[p].levels[chosen[p]].count, finer = parts[p].levels[chosen[p] - 1].count;
    if (total - now + finer > most) continue;  // others may be smaller
    total = total - now + finer;
    --chosen[p];
    add(p);
  }
  return chosen;
}

}  // namespace binosplat
