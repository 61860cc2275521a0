#include "scene/framing.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <vector>

#include "base/parallel.h"
#include "scene/axes.h"

namespace binosplat {

namespace {

/// The map of the floor is a square with this many cells from the core's middle to each side (1 core radius).
constexpr int space_half = 50;
constexpr int space_side = 2 * space_half + 1;

bool is_on_map(const glm::ivec2& cell) {
  return cell.x >= 0 && cell.y >= 0 && cell.x < space_side && cell.y < space_side;
}

std::size_t map_index(const glm::ivec2& cell) {
  return static_cast<std::size_t>(cell.y) * space_side + static_cast<std::size_t>(cell.x);
}

struct Map {
  std::vector<double> cover = std::vector<double>(std::size_t{space_side} * space_side);
  /// 1 if the cell or a neighbour has floor.
  std::vector<char> floor = std::vector<char>(std::size_t{space_side} * space_side);

  /// Returns whether so much of the cell's face is covered that nobody can stand or look there.
  bool taken(const glm::ivec2& cell) const { return cover[map_index(cell)] > 0.25; }

  void add_floor(const glm::ivec2& cell) {
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        const glm::ivec2 beside = cell + glm::ivec2(x, y);
        if (is_on_map(beside)) floor[map_index(beside)] = 1;
      }
    }
  }
};

/// Returns each cell's distance, in cells, to the nearest (or itself) that is taken or has no floor.
std::vector<double> room_in(const Map& map) {
  std::vector<glm::ivec2> closed;
  for (int y = 0; y < space_side; ++y) {
    for (int x = 0; x < space_side; ++x) {
      if (map.taken({x, y}) || map.floor[map_index({x, y})] == 0) closed.emplace_back(x, y);
    }
  }
  std::vector<double> room(std::size_t{space_side} * space_side);
  parallel_for(space_side, [&](int y) {
    for (int x = 0; x < space_side; ++x) {
      int least = space_side * space_side;
      for (const glm::ivec2& cell : closed) {
        const glm::ivec2 d = cell - glm::ivec2(x, y);
        least = std::min(least, d.x * d.x + d.y * d.y);
      }
      room[map_index({x, y})] = std::sqrt(least);
    }
  });
  return room;
}

/// Returns the length of the free straight line from a cell, in cells.
double free_way(const Map& map, const glm::dvec2& from, const glm::dvec2& towards) {
  double way = 0.0;
  for (; way < 2.0 * space_side; way += 0.5) {
    const glm::ivec2 cell = glm::floor(from + way * towards + 0.5);
    if (!is_on_map(cell) || map.taken(cell)) break;
  }
  return way;
}

}  // namespace

std::optional<Capture::Around> open_space(const CoredModel& cored, const Ground& ground, double eyes) {
  const Model& model = cored.model;
  const Core& core = cored.core;
  const double cell_size = core.radius / space_half;
  // The floor's height and directions in the model's frame.
  const glm::dvec3 up = glm::transpose(world_from_axes(model.axes.letters)) * ground.up;
  const auto [aside, ahead] = level_directions(up);
  const double floor = *ground.height - glm::dot(model.axes.origin + core.middle, up);
  Map map;
  for (std::size_t i = 0; i < model.count(); ++i) {
    const glm::dvec3 v = glm::dvec3(model.position[i]) - core.middle;
    const glm::ivec2 cell =
        glm::floor(glm::dvec2(glm::dot(v, aside), glm::dot(v, ahead)) / cell_size + (space_half + 0.5));
    if (!is_on_map(cell)) continue;
    const double height = glm::dot(v, up) - floor;
    if (std::abs(height) < 0.25 * eyes) {
      if (model.opacity[i] > 0.5f) map.add_floor(cell);
    } else if (height > 0.0 && height < 1.25 * eyes) {
      glm::vec3 s = model.scale[i];
      std::sort(&s.x, &s.x + 3);
      map.cover[map_index(cell)] += model.opacity[i] * glm::pi<double>() * s.y * s.z / (cell_size * eyes);
    }
  }
  const std::vector<double> room = room_in(map);
  // More room than this does not count: then the place nearest to the middle wins.
  const double enough = 3.0 * eyes / cell_size, least = 0.3 * eyes / cell_size;
  glm::dvec2 middle{0.0};
  double best = -INFINITY, radius = 0.0;
  for (int y = 0; y < space_side; ++y) {
    for (int x = 0; x < space_side; ++x) {
      const double here = std::min(room[map_index({x, y})], enough);
      const double score = here - 0.1 * std::hypot(x - space_half, y - space_half);
      if (here < least || score <= best) continue;
      best = score;
      middle = {x, y};
      radius = here;
    }
  }
  if (radius == 0.0) return std::nullopt;
  constexpr double to_the_border = 0.7;
  constexpr int places = 16;
  glm::dvec2 first{0.0};
  double farthest = -1.0;
  for (int k = 0; k < places; ++k) {
    const double turn = glm::two_pi<double>() * k / places;
    const glm::dvec2 away(std::cos(turn), std::sin(turn));
    const double seen = free_way(map, middle + to_the_border * radius * away, -away);
    if (seen <= farthest) continue;
    farthest = seen;
    first = away;
  }
  const glm::dvec2 cells = middle - glm::dvec2(space_half);
  const glm::dvec3 place =
      core.middle + cell_size * (cells.x * aside + cells.y * ahead) + (floor + eyes) * up;
  const double distance = to_the_border * radius * cell_size;
  return Capture::Around{
      .middle = into_world(place, model.axes),
      .distance = distance,
      .first = world_from_axes(model.axes.letters) * (first.x * aside + first.y * ahead) * distance};
}

}  // namespace binosplat
