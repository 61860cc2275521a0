// Tests without a runtime: how hands move a head, and which pixels lenses show.

#include "xr/walk.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "xr/projection_layer.h"

namespace binosplat::xr {
namespace {

constexpr double upm = 2.0;  // world units per metre

const Placement start = {.origin = {1.0, 2.0, 3.0}, .units_per_metre = upm};

/// Returns the position in the world of a point in the head's room.
glm::dvec3 in_world(const Placement& at, const glm::dvec3& p) {
  return at.origin + at.units_per_metre * (at.axes * p);
}

Eye head_at(const glm::dvec3& position, double degrees = 0.0) {
  const glm::dquat turn = glm::angleAxis(glm::radians(degrees), glm::dvec3(0, 1, 0));
  return {.position = position, .orientation = {turn.x, turn.y, turn.z, turn.w}};
}

std::array<Hand, 2> sticks(const glm::dvec2& left, const glm::dvec2& right = glm::dvec2(0.0)) {
  std::array<Hand, 2> hands;
  hands[0].stick = left;
  hands[1].stick = right;
  return hands;
}

TEST(Walk, FollowsHeadDirection) {
  Walk walk(start);
  walk.step(head_at({0, 1.6, 0}, 90.0), sticks({0, 1}), 0.5);  // turned to the left: looks along -x
  const glm::dvec3 moved = glm::transpose(start.axes) * (walk.placement().origin - start.origin) / upm;
  EXPECT_NEAR(glm::length(moved - glm::dvec3(-0.75, 0, 0)), 0.0, 1e-12) << "1.5 m/s";
  walk.reset();
  walk.step(head_at({0, 1.6, 0}), sticks({0.1, 0.1}), 1.0);
  EXPECT_EQ(walk.placement().origin, start.origin) << "a stick at rest is never quite at rest";
}

TEST(Walk, TurnsOncePerPush) {
  Walk walk(start);
  const Eye head = head_at({0.4, 1.6, -0.3});
  const glm::dvec3 before = in_world(walk.placement(), head.position);
  walk.step(head, sticks({}, {1, 0}), 0.01);
  walk.step(head, sticks({}, {1, 0}), 0.01);
  EXPECT_NEAR(glm::length(in_world(walk.placement(), head.position) - before), 0.0, 1e-12);
  // After a turn to the right, the earlier forward direction points to the left.
  const glm::dvec3 ahead = glm::transpose(start.axes) * (walk.placement().axes * glm::dvec3(0, 0, -1));
  EXPECT_NEAR(ahead.x, std::sin(glm::radians(30.0)), 1e-12);
  EXPECT_NEAR(ahead.z, -std::cos(glm::radians(30.0)), 1e-12);
  walk.step(head, sticks({}, {0, 0}), 0.01);
  walk.step(head, sticks({}, {1, 0}), 0.01);
  EXPECT_NEAR((glm::transpose(start.axes) * (walk.placement().axes * glm::dvec3(0, 0, -1))).x,
              std::sin(glm::radians(60.0)), 1e-12);
}

std::array<Hand, 2> holding(const glm::dvec3& left, const glm::dvec3& right, bool both) {
  std::array<Hand, 2> hands;
  hands[0] = {.position = left, .grabs = both};
  hands[1] = {.position = right, .grabs = true};
  return hands;
}

TEST(Walk, GrabKeepsPointInHand) {
  Walk walk(start);
  const Eye head = head_at({0, 1.6, 0});
  const glm::dvec3 from(0.2, 1.2, -0.4), to(0.5, 1.0, -0.1);
  walk.step(head, holding({}, from, false), 0.01);
  const glm::dvec3 held = in_world(walk.placement(), from);
  walk.step(head, holding({}, to, false), 0.01);
  EXPECT_NEAR(glm::length(in_world(walk.placement(), to) - held), 0.0, 1e-12);
  EXPECT_EQ(walk.placement().units_per_metre, upm);
}

TEST(Walk, TwoHandsTurnAndScale) {
  Walk walk(start);
  const Eye head = head_at({0, 1.6, 0});
  const glm::dvec3 left(-0.2, 1.2, -0.4), right(0.2, 1.2, -0.4);
  const glm::dvec3 left_to(-0.1, 1.3, -0.9), right_to(-0.1, 1.3, -0.1);  // twice as far apart, and rotated
  walk.step(head, holding(left, right, true), 0.01);
  const glm::dvec3 held[] = {in_world(walk.placement(), left), in_world(walk.placement(), right)};
  walk.step(head, holding(left_to, right_to, true), 0.01);
  EXPECT_NEAR(walk.placement().units_per_metre, upm / 2.0, 1e-12);
  EXPECT_NEAR(glm::length(in_world(walk.placement(), left_to) - held[0]), 0.0, 1e-9);
  EXPECT_NEAR(glm::length(in_world(walk.placement(), right_to) - held[1]), 0.0, 1e-9);
  EXPECT_NEAR(glm::length(in_world(walk.placement(), left_to) - held[1]), 0.4 * upm, 1e-9)
      << "hands that are swapped would go unnoticed";
}

TEST(Walk, StartsAtCamera) {
  const glm::dvec3 position(1, 2, 3), up(0, -1, 0);
  const glm::dmat3 down(glm::mat3_cast(glm::angleAxis(0.7, glm::dvec3(1, 0, 0))));
  const Placement standing = upright_at(position, down, up, upm), floor = start_of(standing, true);
  EXPECT_EQ(start_of(standing, false).origin, position);
  EXPECT_NEAR(glm::length(in_world(floor, {0, 1.6, 0}) - position), 0.0, 1e-12);
  EXPECT_NEAR(glm::length(standing.axes[1] - up), 0.0, 1e-12) << "upright";
  EXPECT_NEAR(glm::length(standing.axes[2] - glm::dvec3(0, 0, -1)), 0.0, 1e-12) << "heading";
  EXPECT_NEAR(glm::determinant(standing.axes), 1.0, 1e-12);
}

TEST(VisibleColumns, MatchTriangles) {
  const Fov fov = {-0.8, 0.6, 0.7, -0.5};
  const glm::ivec2 size(320, 256);
  constexpr int tile = ViewRegion::tile;
  // A disk, like the visible part of a lens.
  Mask disk;
  disk.vertices.push_back({0.0f, 0.05f});
  constexpr std::uint32_t around = 40;
  for (std::uint32_t k = 0; k < around; ++k) {
    const double angle = 2.0 * M_PI * k / around;
    disk.vertices.push_back(
        {static_cast<float>(0.55 * std::cos(angle)), static_cast<float>(0.05 + 0.45 * std::sin(angle))});
    disk.indices.insert(disk.indices.end(), {0, k + 1, (k + 1) % around + 1});
  }
  const auto columns = visible_columns(disk, fov, size);
  ASSERT_EQ(columns.size(), 16u);
  const double left = std::tan(fov.left), right = std::tan(fov.right);
  const double up = std::tan(fov.up), down = std::tan(fov.down);
  std::size_t missed = 0, needless = 0, upside_down = 0;
  for (std::size_t row = 0; row < columns.size(); ++row) {
    for (unsigned column = 0; column < 20; ++column) {
      double nearest = 1e9;  // distance from the disk's middle, in its radii
      for (int p = 0; p < tile * tile; ++p) {
        const int px = p % tile, py = p / tile;
        const double x = left + (column * tile + px + 0.5) / size.x * (right - left);
        const double y = up - (row * tile + py + 0.5) / size.y * (up - down);
        nearest = std::min(nearest, std::hypot(x / 0.55, (y - 0.05) / 0.45));
      }
      const bool drawn = column >= columns[row].x && column < columns[row].y;
      const auto& mirrored = columns[columns.size() - 1 - row];
      missed += nearest < 0.99 && !drawn ? 1 : 0;
      needless += nearest > 1.1 && drawn ? 1 : 0;
      upside_down += nearest < 0.99 && !(column >= mirrored.x && column < mirrored.y) ? 1 : 0;
    }
  }
  EXPECT_EQ(missed, 0u);
  EXPECT_EQ(needless, 0u);
  EXPECT_GT(upside_down, 5u) << "the wrong way up goes unnoticed";
  EXPECT_TRUE(visible_columns({}, fov, size).empty()) << "no mask: all";
  disk.vertices[3] = {NAN, 0.0f};
  EXPECT_EQ(visible_columns(disk, fov, size).size(), 16u) << "numbers that are none";
}

}  // namespace
}  // namespace binosplat::xr
