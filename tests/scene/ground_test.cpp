#include "scene/ground.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/quaternion.hpp>

#include "base/error.h"
#include "scene/axes.h"
#include "scene/transform.h"
#include "support/surfaces.h"

namespace binosplat {
namespace {

using test::furnished_room;
using test::garden;
using test::Surfaces;

/// Returns a closed box of 4 x 4 x height, with the same density on all sides.
Model box(double height) {
  Surfaces out;
  const glm::dvec3 x(4, 0, 0), y(0, 4, 0), z(0, 0, height);
  for (const glm::dvec3& corner : {glm::dvec3(0), z}) out.add(corner, x, y, 4000);
  for (const glm::dvec3& corner : {glm::dvec3(0), y}) out.add(corner, x, z, static_cast<int>(1000 * height));
  for (const glm::dvec3& corner : {glm::dvec3(0), x}) out.add(corner, y, z, static_cast<int>(1000 * height));
  return out.model;
}

/// Returns an evenly spread ball (Fibonacci spiral).
Model ball_of_surfaces() {
  Surfaces out;
  constexpr int count = 8000;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / count, ring = std::sqrt(1.0 - z * z), turn = 2.399963 * i;
    const glm::dvec3 n(ring * std::cos(turn), ring * std::sin(turn), z);
    const glm::dvec3 aside = glm::normalize(glm::cross(n, glm::dvec3(1, 2, 3)));
    out.add(n, 1e-3 * aside, 1e-3 * glm::cross(n, aside), 1);
  }
  return out.model;
}

double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0)));
}

Model turned(Model model, const glm::dquat& by) {
  std::vector<glm::dvec3> places;
  EXPECT_TRUE(transform(model, glm::mat4_cast(by), places));
  return model;
}

const glm::dvec3 z_up(0, 0, 1);

TEST(Ground, IsDominantLowestSurface) {
  for (const glm::dquat& by :
       {glm::dquat(1, 0, 0, 0), glm::angleAxis(glm::half_pi<double>(), glm::dvec3(1, 0, 0)),
        glm::angleAxis(2.0, glm::normalize(glm::dvec3(1, -2, 0.5)))}) {
    const auto found = find_ground(turned(garden(), by));
    ASSERT_TRUE(found);
    EXPECT_LT(degrees_between(found->up, by * z_up), 1.0);
    ASSERT_TRUE(found->height);
    EXPECT_NEAR(*found->height, 0.0, 0.05);
  }
  const auto of_a_room = find_ground(furnished_room({5, 5, 5}));
  ASSERT_TRUE(of_a_room && of_a_room->height);
  EXPECT_LT(degrees_between(of_a_room->up, z_up), 1.0);
  EXPECT_NEAR(*of_a_room->height, 5.0, 0.05);
}

TEST(Ground, IsFoundAmongManyRoundGaussians) {
  Surfaces out;
  out.add({-10, -10, 0}, {20, 0, 0}, {0, 20, 0}, 1500);
  out.add({-10, 9, 0}, {20, 0, 0}, {0, 0, 2}, 400);
  for (int i = 0; i < 600000; ++i)
    test::add(out.model, {out.next(-10, 10), out.next(-10, 10), out.next(0, 2)}, glm::vec3(0.01f), 0.9f);
  const auto found = find_ground(out.model);
  ASSERT_TRUE(found && found->height);
  EXPECT_LT(degrees_between(found->up, z_up), 1.0);
  EXPECT_NEAR(*found->height, 0.0, 0.05);
}

TEST(Ground, FewLargeGaussiansDoNotDecide) {
  Surfaces out{garden()};
  const std::size_t small = out.model.count();
  out.add({-4, 0, 4}, {4, 0, 4}, {0, 4, 0}, 150);
  for (std::size_t i = small; i < out.model.count(); ++i) out.model.scale[i] *= 10.0f;
  const auto found = find_ground(out.model);
  ASSERT_TRUE(found && found->height);
  EXPECT_LT(degrees_between(found->up, z_up), 1.0);
  EXPECT_NEAR(*found->height, 0.0, 0.05);
}

TEST(Ground, IsInWorldAxes) {
  Model model = garden();
  model.axes.letters = "RFU";  // x right, y forward, z up
  const auto found = find_ground(model);
  ASSERT_TRUE(found);
  EXPECT_LT(degrees_between(found->up, {0, -1, 0}), 1.0);
}

TEST(Ground, UpComesFromWallsWithoutFloor) {
  Surfaces walls;  // like a house with a bay
  for (const double turn : {0.0, 0.6, 1.2, 1.8, 2.4})
    walls.add({turn, 0, 0}, {0, -4, 0}, {std::cos(turn), 0, std::sin(turn)}, 1000);
  const auto found = find_ground(walls.model);
  ASSERT_TRUE(found);
  EXPECT_LT(degrees_between(found->up, {0, -1, 0}), 2.0) << "y is down where nothing tells";
  EXPECT_FALSE(found->height);
}

TEST(Ground, IsNoneWithoutEvidence) {
  EXPECT_FALSE(find_ground(garden(1.0f))) << "round Gaussians face nowhere";
  EXPECT_THROW(find_ground(Model{}), Error);
  Model points = garden();
  for (glm::vec3& s : points.scale) s = glm::vec3(0.0f);  // as from logarithms like -110
  EXPECT_FALSE(find_ground(points)) << "they have no area";
  Surfaces few;
  few.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 100);
  EXPECT_FALSE(find_ground(few.model));
}

TEST(Ground, IsNoneForTiedDirections) {
  EXPECT_FALSE(find_ground(ball_of_surfaces())) << "faces everywhere";
  EXPECT_FALSE(find_ground(box(4.0))) << "as much wall as floor, three times";
  const auto low = find_ground(box(3.0));
  ASSERT_TRUE(low) << "more floor than wall";
  EXPECT_LT(degrees_between(low->up, z_up), 2.0);
}

TEST(Ground, UsesKnownUp) {
  const auto found = find_ground(garden(), glm::dvec3(0, 0, 2));
  ASSERT_TRUE(found && found->height);
  EXPECT_EQ(found->up, z_up);
  EXPECT_NEAR(*found->height, 0.0, 0.05);
  const auto askew = find_ground(garden(), glm::dvec3(1, 0, 0));
  ASSERT_TRUE(askew);
  EXPECT_FALSE(askew->height) << "nothing is level";
}

}  // namespace
}  // namespace binosplat
