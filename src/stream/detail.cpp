#include "stream/detail.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "stream/detail_parts.h"

namespace binosplat {

namespace {

/// From the nearest eye; 1 without eyes.
double distance_to(const DetailPart& part, const std::vector<glm::dvec3>& eyes) {
  if (eyes.empty()) return 1.0;
  double nearest = INFINITY;
  for (const glm::dvec3& eye : eyes) nearest = std::min(nearest, distance_to(part, eye));
  return nearest;
}

std::array<glm::dvec3, 5> inward_of(const shared::View& view) {
  const glm::dvec3 right(view.row_x), down(view.row_y), ahead(view.row_z);
  const glm::dvec2 focal(view.lens.x, view.lens.y), first(view.lens.z, view.lens.w),
      last = glm::dvec2(view.width, view.height) - first;
  std::array<glm::dvec3, 5> inward = {focal.x * right + first.x * ahead, last.x * ahead - focal.x * right,
                                      focal.y * down + first.y * ahead, last.y * ahead - focal.y * down,
                                      ahead};
  for (glm::dvec3& normal : inward) normal = glm::normalize(normal);
  return inward;
}

}  // namespace

glm::dvec3 detail_direction(std::size_t d) {
  glm::dvec3 direction(0.0);
  direction[static_cast<glm::length_t>(d / 2)] = d % 2 == 0 ? 1.0 : -1.0;
  return direction;
}

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
    const double stays = inertia_of(before, p, chosen[p] - 1);
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
    const std::size_t now = parts[p].levels[chosen[p]].count;
    const std::size_t finer = parts[p].levels[chosen[p] - 1].count;
    if (total - now + finer > most) continue;  // others may be smaller
    total = total - now + finer;
    --chosen[p];
    add(p);
  }
  return chosen;
}

std::vector<DetailView> detail_views(std::span<const shared::View> views) {
  std::vector<DetailView> result;
  for (const shared::View& view : views) {
    result.push_back({.eye = glm::dvec3(view.anchor) + glm::dvec3(view.eye),
                      .inward = inward_of(view),
                      .focal = std::max<double>(view.lens.x, view.lens.y),
                      .pixels = static_cast<double>(view.width) * view.height});
  }
  return result;
}

double psnr_of_error(double squared) { return -10.0 * std::log10(squared); }

double error_of_psnr(double db) { return std::pow(10.0, -0.1 * db); }

double levels_share(double together_db) { return psnr_of_error(0.5 * error_of_psnr(together_db)); }

double left_of(double together_db, double asked_db, double now_db) {
  constexpr double least = 0.1;  // of all, whatever was asked for
  const double all = error_of_psnr(together_db);
  return psnr_of_error(std::max(all - std::min(error_of_psnr(now_db), error_of_psnr(asked_db)), least * all));
}

double psnr_of_both(double a_db, double b_db) {
  return psnr_of_error(error_of_psnr(a_db) + error_of_psnr(b_db));
}

}  // namespace binosplat
