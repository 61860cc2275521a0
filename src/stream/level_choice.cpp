#include "stream/level_choice.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "stream/hysteresis.h"

namespace binosplat {

namespace {

/// Returns the distance to the nearest eye; 1 without eyes.
double distance_to(const LodChunk& chunk, const std::vector<glm::dvec3>& eyes) {
  if (eyes.empty()) return 1.0;
  double nearest = INFINITY;
  for (const glm::dvec3& eye : eyes) nearest = std::min(nearest, distance_to(chunk, eye));
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

std::vector<std::size_t> choose_by_spacing(const std::vector<LodChunk>& chunks,
                                           const std::vector<glm::dvec3>& eyes, std::size_t most,
                                           double spacing_wanted, std::span<const std::size_t> before) {
  struct Coarse {
    double apart;  // spacing of its Gaussians, radians
    std::size_t chunk;
    bool operator<(const Coarse& other) const { return apart < other.apart; }
  };
  std::vector<std::size_t> chosen(chunks.size(), 0);
  std::priority_queue<Coarse> coarse;
  std::size_t total = 0;
  const auto add = [&](std::size_t p) {
    const LodChunk& chunk = chunks[p];
    if (chosen[p] == 0) return;  // already the finest level
    const auto count = static_cast<double>(std::max<std::size_t>(chunk.levels[chosen[p]].count, 1));
    const double diagonal = glm::distance(chunk.low, chunk.high);
    const double stays = inertia_of(before, p, chosen[p] - 1);
    const double apart = stays * diagonal / std::sqrt(count) / distance_to(chunk, eyes);
    if (apart > spacing_wanted) coarse.push({apart, p});
  };
  for (std::size_t p = 0; p < chunks.size(); ++p) {
    if (chunks[p].levels.empty()) continue;
    chosen[p] = chunks[p].levels.size() - 1;
    total += chunks[p].levels.back().count;
    add(p);
  }
  while (!coarse.empty()) {
    const std::size_t p = coarse.top().chunk;
    coarse.pop();
    const std::size_t now = chunks[p].levels[chosen[p]].count;
    const std::size_t finer = chunks[p].levels[chosen[p] - 1].count;
    if (total - now + finer > most) continue;  // another chunk's step may fit
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

LevelChoice choose_levels(const std::vector<LodChunk>& chunks, std::span<const shared::View> views,
                          const DetailRequest& request, const VisibleChunks& visible,
                          std::span<const std::size_t> before) {
  const std::vector<DetailView> detail = detail_views(views);
  if (request.db && !views.empty()) {
    const double error = error_of_psnr(*request.db) / request.loss_correction;
    return choose_by_error(chunks, detail,
                           {error, request.max_gaussians, request.heads_turn, request.max_read}, visible,
                           before);
  }
  std::vector<glm::dvec3> eyes;
  double focal = 0.0;
  for (const DetailView& view : detail) {
    eyes.push_back(view.eye);
    focal = std::max(focal, view.focal);
  }
  const double spacing_wanted = views.empty() ? INFINITY : request.spacing_px / focal;
  return {.levels = choose_by_spacing(chunks, eyes, request.max_gaussians, spacing_wanted, before)};
}

double psnr_of_error(double squared) { return -10.0 * std::log10(squared); }

double error_of_psnr(double db) { return std::pow(10.0, -0.1 * db); }

double levels_target_db(double together_db) { return psnr_of_error(0.5 * error_of_psnr(together_db)); }

double frame_target_db(double together_db, double levels_db) {
  constexpr double least = 0.1;
  const double all = error_of_psnr(together_db);
  return psnr_of_error(std::max(all - error_of_psnr(levels_db), least * all));
}

double psnr_of_both(double a_db, double b_db) {
  return psnr_of_error(error_of_psnr(a_db) + error_of_psnr(b_db));
}

}  // namespace binosplat
