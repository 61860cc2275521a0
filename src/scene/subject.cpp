#include "scene/subject.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numeric>

#include "scene/axes.h"

namespace binosplat {

namespace {

/// Larger models are sampled.
constexpr std::size_t splat_sample = 100000;
/// Alpha that is seen.
constexpr double seen = 0.04;

/// A cube of cells around the core.
constexpr int cells = 96;
constexpr double cube = 6.0;  // from its middle to a side
constexpr double cell_size = 2.0 * cube / cells;

std::size_t cell_index(const glm::ivec3& cell) {
  return (static_cast<std::size_t>(cell.z) * cells + static_cast<std::size_t>(cell.y)) * cells +
         static_cast<std::size_t>(cell.x);
}

bool is_cell(const glm::ivec3& cell) {
  return glm::all(glm::greaterThanEqual(cell, glm::ivec3(0))) &&
         glm::all(glm::lessThan(cell, glm::ivec3(cells)));
}

glm::ivec3 cell_of(const SampledSplat& splat) {
  return glm::floor((glm::clamp(splat.place, -1e3, 1e3) + cube) / cell_size);
}

/// Cells by the part that each belongs to; 0: none. Cells of a part are at most two cells apart.
struct Parts {
  std::vector<int> of = std::vector<int>(std::size_t{cells} * cells * cells);
  std::vector<double> cover{0.0};  // by part

  explicit Parts(const std::vector<double>& cell_cover, double least) {
    std::vector<glm::ivec3> reached;
    for (std::size_t first = 0; first < of.size(); ++first) {
      if (cell_cover[first] < least || of[first] != 0) continue;
      const int part = static_cast<int>(cover.size());
      cover.push_back(0.0);
      const auto i = static_cast<int>(first);
      reached.emplace_back(i % cells, i / cells % cells, i / (cells * cells));
      of[first] = part;
      while (!reached.empty()) {
        const glm::ivec3 cell = reached.back();
        reached.pop_back();
        cover.back() += cell_cover[cell_index(cell)];
        for (int k = 0; k < 125; ++k) {
          const glm::ivec3 beside = cell + glm::ivec3(k % 5, k / 5 % 5, k / 25) - 2;
          if (!is_cell(beside) || of[cell_index(beside)] != 0 || cell_cover[cell_index(beside)] < least)
            continue;
          of[cell_index(beside)] = part;
          reached.push_back(beside);
        }
      }
    }
  }
};

}  // namespace

std::vector<SampledSplat> visible_splats(const CoredModel& cored) {
  const Model& model = cored.model;
  std::vector<SampledSplat> splats;
  if (model.scaffold) return splats;
  const glm::dmat3 world = world_from_axes(model.axes.letters);
  const double unit = cored.core.radius;
  const std::size_t stride = model.count() / splat_sample + 1;
  for (std::size_t i = 0; i < model.count(); i += stride) {
    const double opacity = model.opacity[i];
    if (opacity <= seen) continue;
    const glm::dvec3 scale = glm::dvec3(model.scale[i]) / unit;
    const double smallest = std::min({scale.x, scale.y, scale.z});
    if (!(smallest < 1.0)) continue;  // a huge one is sky or fog
    std::array<double, 3> s{scale.x, scale.y, scale.z};
    std::sort(s.begin(), s.end());
    const glm::vec4& q = model.rotation[i];
    const glm::dmat3 turned = glm::mat3_cast(glm::dquat(q.x, q.y, q.z, q.w));
    glm::dmat3 half_axes = world * turned;
    const double sigmas = std::sqrt(2.0 * std::log(opacity / seen));
    for (int k = 0; k < 3; ++k) half_axes[k] *= sigmas * scale[k];
    splats.push_back({world * ((glm::dvec3(model.position[i]) - cored.core.middle) / unit), half_axes,
                      opacity * glm::two_pi<double>() * s[1] * s[2] * static_cast<double>(stride)});
  }
  return splats;
}

bool surrounds(const std::vector<SampledSplat>& splats, const glm::dvec3& eye, const glm::dvec3& forward,
               const glm::dvec3& up) {
  // The half circle behind the viewer, in sectors from 20 degrees below the horizon to 40 above it.
  constexpr int sectors = 12;
  const double low = std::sin(glm::radians(-20.0)), high = std::sin(glm::radians(40.0));
  const double whole = glm::pi<double>() / sectors * (high - low);  // sr
  const glm::dvec3 aside = glm::cross(forward, up);
  std::array<double, sectors> covered{};
  for (const SampledSplat& splat : splats) {
    const glm::dvec3 v = splat.place - eye;
    const double square = glm::dot(v, v), back = -glm::dot(v, forward);
    const double rise = glm::dot(v, up) / std::sqrt(square);
    if (back <= 0.0 || !(rise > low && rise < high)) continue;
    const double turn = std::atan2(glm::dot(v, aside), back) / glm::pi<double>() + 0.5;
    const auto sector = std::min(static_cast<std::size_t>(turn * sectors), std::size_t{sectors - 1});
    covered[sector] += std::min(splat.cover / square, 0.35 * whole);
  }
  const auto some = std::count_if(covered.begin(), covered.end(), [&](double c) { return c > 0.35 * whole; });
  return 2 * some > sectors;
}

bool is_free(const std::vector<SampledSplat>& splats, const glm::dvec3& eye, double near) {
  double sum = 0.0;  // sr
  for (const SampledSplat& splat : splats) {
    const double distance = glm::distance(splat.place, eye);
    if (distance < near) sum += std::min(1.0, splat.cover / (distance * distance));
  }
  return sum < 1.0;
}

std::vector<SampledSplat> without_floaters(const std::vector<SampledSplat>& splats) {
  std::vector<double> cover(std::size_t{cells} * cells * cells);
  constexpr double full = cell_size * cell_size;
  for (const SampledSplat& splat : splats) {
    if (is_cell(cell_of(splat))) cover[cell_index(cell_of(splat))] += std::min(splat.cover, full);
  }
  // A cell counts if it covers a 25th of its face, or as much as the usual cell of a sparse model.
  std::vector<double> taken;
  std::copy_if(cover.begin(), cover.end(), std::back_inserter(taken), [](double c) { return c > 0.0; });
  if (taken.empty()) return {};
  std::nth_element(taken.begin(), taken.begin() + static_cast<std::ptrdiff_t>(taken.size() / 2), taken.end());
  const Parts parts(cover, std::min(seen * full, taken[taken.size() / 2]));
  constexpr double share = 0.03;
  const double all = std::accumulate(parts.cover.begin(), parts.cover.end(), 0.0);
  std::vector<SampledSplat> kept;
  for (const SampledSplat& splat : splats) {
    if (!is_cell(cell_of(splat))) continue;
    const int part = parts.of[cell_index(cell_of(splat))];
    if (part != 0 && parts.cover[static_cast<std::size_t>(part)] > share * all) kept.push_back(splat);
  }
  return kept;
}

}  // namespace binosplat
