#include "scene/open_space.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <vector>

#include "base/parallel.h"
#include "scene/axes.h"

namespace binosplat {

namespace {

/// Cells from the middle of the map to its border, which is a radius of the core away.
constexpr int space_half = 50;
constexpr int space_side = 2 * space_half + 1;
/// What of a cell's face must be covered for nobody to stand or look there.
constexpr double covered = 0.25;

/// A map of the floor, in cells.
struct Map {
  std::vector<double> cover = std::vector<double>(std::size_t{space_side} * space_side);
  std::vector<char> floor = std::vector<char>(std::size_t{space_side} * space_side);

  static bool inside(const glm::ivec2& cell) {
    return cell.x >= 0 && cell.y >= 0 && cell.x < space_side && cell.y < space_side;
  }
  static std::size_t index(const glm::ivec2& cell) {
    return static_cast<std::size_t>(cell.y) * space_side + static_cast<std::size_t>(cell.x);
  }
  bool taken(const glm::ivec2& cell) const { return cover[index(cell)] > covered; }
  bool stands(const glm::ivec2& cell) const {
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        const glm::ivec2 beside = cell + glm::ivec2(x, y);
        if (inside(beside) && floor[index(beside)] != 0) return true;
      }
    }
    return false;
  }
};

/// The floor's directions and the map's place, in the model's frame.
struct Plan {
  Core core;
  const ModelAxes& axes;
  glm::dvec3 up, aside, ahead;
  double floor, cell;

  Plan(const CoredModel& cored, const Ground& ground)
      : core(cored.core), axes(cored.model.axes), cell(core.radius / space_half) {
    up = glm::transpose(world_from_axes(axes.letters)) * ground.up;
    aside = level_directions(up)[0];
    ahead = level_directions(up)[1];
    floor = *ground.height - glm::dot(axes.origin + core.middle, up);
  }

  glm::dvec3 place(const glm::dvec2& at, double height) const {
    return core.middle + cell * ((at.x - space_half) * aside + (at.y - space_half) * ahead) +
           (floor + height) * up;
  }
};

Map map_of(const Model& model, const Plan& plan, double eyes) {
  Map map;
  for (std::size_t i = 0; i < model.count(); ++i) {
    const glm::dvec3 v = glm::dvec3(model.position[i]) - plan.core.middle;
    const glm::ivec2 cell = glm::floor(
        glm::dvec2(glm::dot(v, plan.aside), glm::dot(v, plan.ahead)) / plan.cell + (space_half + 0.5));
    if (!Map::inside(cell)) continue;
    const double height = glm::dot(v, plan.up) - plan.floor;
    const std::size_t at = Map::index(cell);
    if (std::abs(height) < 0.25 * eyes) {
      if (model.opacity[i] > 0.5f) map.floor[at] = 1;
    } else if (height > 0.0 && height < 1.25 * eyes) {
      glm::vec3 s = model.scale[i];
      std::sort(&s.x, &s.x + 3);
      map.cover[at] += model.opacity[i] * glm::pi<double>() * s.y * s.z / (plan.cell * eyes);
    }
  }
  return map;
}

/// How far, in cells, from each cell to the nearest that is taken or has no floor; 0 for those themselves.
std::vector<double> room_in(const Map& map) {
  std::vector<glm::ivec2> closed;
  for (int y = 0; y < space_side; ++y) {
    for (int x = 0; x < space_side; ++x) {
      if (map.taken({x, y}) || !map.stands({x, y})) closed.emplace_back(x, y);
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
      room[Map::index({x, y})] = std::sqrt(least);
    }
  });
  return room;
}

/// How far one gets along straight lines before something is in the way, in cells.
double free_way(const Map& map, const glm::dvec2& from, const glm::dvec2& towards) {
  double way = 0.0;
  for (; way < 2.0 * space_side; way += 0.5) {
    const glm::ivec2 cell = glm::floor(from + way * towards + 0.5);
    if (!Map::inside(cell) || map.taken(cell)) break;
  }
  return way;
}

}  // namespace

std::optional<Capture::Around> open_space(const CoredModel& cored, const Ground& ground, double eyes) {
  const Plan plan(cored, ground);
  const Map map = map_of(cored.model, plan, eyes);
  const std::vector<double> room = room_in(map);
  // More room than this is no better; then what is near the middle is.
  const double enough = 3.0 * eyes / plan.cell, least = 0.3 * eyes / plan.cell;
  glm::dvec2 middle{0.0};
  double best = -std::numeric_limits<double>::infinity(), radius = 0.0;
  for (int y = 0; y < space_side; ++y) {
    for (int x = 0; x < space_side; ++x) {
      const double here = room[Map::index({x, y})];
      const double score = std::min(here, enough) - 0.1 * std::hypot(x - space_half, y - space_half);
      if (here < least || score <= best) continue;
      best = score;
      middle = {x, y};
      radius = std::min(here, enough);
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
  Capture::Around around{into_world(plan.place(middle, eyes), plan.axes)};
  around.distance = to_the_border * radius * plan.cell;
  around.first =
      world_from_axes(plan.axes.letters) * (first.x * plan.aside + first.y * plan.ahead) * around.distance;
  return around;
}

}  // namespace binosplat
