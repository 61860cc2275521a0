#include "scene/ground.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/quaternion.hpp>
#define GLM_ENABLE_EXPERIMENTAL
#include <glm/gtx/quaternion.hpp>
#include <random>

#include "base/error.h"
#include "scene/axes.h"
#include "scene/framing.h"
#include "scene/reduce.h"
#include "scene/transform.h"
#include "support/models.h"

namespace binosplat {
namespace {

/// Surfaces of flat Gaussians with slightly random normals, at random positions in rectangles.
struct Surfaces {
  Model model;
  std::mt19937 random{1};

  double next(double low, double high) { return std::uniform_real_distribution(low, high)(random); }

  /// Adds the rectangle of `across` and `along` at a corner. `thick` is the smallest scale relative to the
  /// others.
  void add(const glm::dvec3& corner, const glm::dvec3& across, const glm::dvec3& along, int count,
           float thick = 0.1f) {
    const glm::dvec3 normal = glm::normalize(glm::cross(across, along));
    for (int i = 0; i < count; ++i) {
      const glm::dvec3 n = glm::normalize(normal + 0.1 * glm::dvec3(next(-1, 1), next(-1, 1), next(-1, 1)));
      // The shortest axis, z, is along the normal.
      const glm::dquat q = glm::rotation(glm::dvec3(0, 0, 1), n);
      const glm::dvec3 place = corner + next(0, 1) * across + next(0, 1) * along;
      test::add(model, place, {0.1f, 0.1f, 0.1f * thick}, 0.9f, glm::vec3(0.5f), {q.w, q.x, q.y, q.z});
    }
  }
};

/// Returns a lawn of 20 x 20 around the origin, z up, with a table in the middle and a hedge on one side.
Model garden(float thick = 0.1f) {
  Surfaces out;
  out.add({-10, -10, 0}, {20, 0, 0}, {0, 20, 0}, 6000, thick);
  out.add({-1, -1, 0.8}, {2, 0, 0}, {0, 2, 0}, 800, thick);
  out.add({-10, 9, 0}, {20, 0, 0}, {0, 0, 2}, 1500, thick);
  return out.model;
}

/// Returns a room of 6 x 5 x 2.6, one of many in a flat: four walls, floor, ceiling, a cupboard.
Model furnished_room(const glm::dvec3& at = {}) {
  Surfaces out;
  const glm::dvec3 x(6, 0, 0), y(0, 5, 0), z(0, 0, 2.6);
  for (const glm::dvec3& corner : {glm::dvec3(0), z}) out.add(at + corner, x, y, 3000);
  for (const glm::dvec3& corner : {glm::dvec3(0), y}) out.add(at + corner, x, z, 1500);
  for (const glm::dvec3& corner : {glm::dvec3(0), x}) out.add(at + corner, y, z, 1300);
  out.add(at + glm::dvec3(0, 1, 0), {0.6, 0, 0}, {0, 0, 1}, 300);
  out.add(at + glm::dvec3(0, 1, 1), {0.6, 0, 0}, {0, 1, 0}, 300);
  return out.model;
}

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

TEST(Ground, IsWhereMostSurfacesFaceAndTheModelBegins) {
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

TEST(Ground, IsTheWorldsWhateverTheModelsAxes) {
  Model model = garden();
  model.axes.letters = "RFU";  // x right, y forward, z up
  const auto found = find_ground(model);
  ASSERT_TRUE(found);
  EXPECT_LT(degrees_between(found->up, {0, -1, 0}), 1.0);
}

TEST(Ground, WallsAloneTellUpButNoFloor) {
  Surfaces walls;  // like a house with a bay
  for (const double turn : {0.0, 0.6, 1.2, 1.8, 2.4})
    walls.add({turn, 0, 0}, {0, -4, 0}, {std::cos(turn), 0, std::sin(turn)}, 1000);
  const auto found = find_ground(walls.model);
  ASSERT_TRUE(found);
  EXPECT_LT(degrees_between(found->up, {0, -1, 0}), 2.0) << "y is down where nothing tells";
  EXPECT_FALSE(found->height);
}

TEST(Ground, WhereNothingTellsThereIsNone) {
  EXPECT_FALSE(find_ground(garden(1.0f))) << "round Gaussians face nowhere";
  EXPECT_THROW(find_ground(Model{}), Error);
  Model points = garden();
  for (glm::vec3& s : points.scale) s = glm::vec3(0.0f);  // as from logarithms like -110
  EXPECT_FALSE(find_ground(points)) << "they have no area";
  Surfaces few;
  few.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 100);
  EXPECT_FALSE(find_ground(few.model));
}

TEST(Ground, WhereDirectionsTieThereIsNone) {
  EXPECT_FALSE(find_ground(ball_of_surfaces())) << "faces everywhere";
  EXPECT_FALSE(find_ground(box(4.0))) << "as much wall as floor, three times";
  const auto low = find_ground(box(3.0));
  ASSERT_TRUE(low) << "more floor than wall";
  EXPECT_LT(degrees_between(low->up, z_up), 2.0);
}

TEST(Ground, UpThatIsKnownIsTaken) {
  const auto found = find_ground(garden(), glm::dvec3(0, 0, 2));
  ASSERT_TRUE(found && found->height);
  EXPECT_EQ(found->up, z_up);
  EXPECT_NEAR(*found->height, 0.0, 0.05);
  const auto askew = find_ground(garden(), glm::dvec3(1, 0, 0));
  ASSERT_TRUE(askew);
  EXPECT_FALSE(askew->height) << "nothing is level";
}

TEST(Standing, IsOnTheFloorAndLooksAtTheMiddle) {
  const Model model = garden();
  const Capture capture = capture_of(model, *find_ground(model), 1.6);
  ASSERT_TRUE(capture.around);
  const Camera camera = frame_model(model, 640, 360, 60.0, capture);
  EXPECT_NEAR(camera.position.z, 1.6, 0.1);
  EXPECT_LT(glm::length(glm::dvec2(camera.position)), 10.0) << "on the lawn";
  EXPECT_GT(glm::dot(camera.rotation[2], glm::normalize(-camera.position)), 0.9);
}

TEST(Standing, IsInARoomAndNotInItsWalls) {
  // Three rooms in a row: the middle of all rooms lies in a wall.
  Model model = furnished_room();
  for (const double x : {6.0, 12.0, 18.0}) {
    const Model other = furnished_room({x, 0, 0});
    append(model, other, 0, other.count());
  }
  const auto ground = find_ground(model);
  ASSERT_TRUE(ground && ground->height);
  const auto open = open_space(model, *ground, 1.6);
  ASSERT_TRUE(open);
  for (const Camera& camera : orbit(model, 8, 64, 48, 60.0, {ground->up, open})) {
    const glm::dvec3& p = camera.position;
    EXPECT_NEAR(p.z, 1.6, 0.1);
    EXPECT_GT(p.y, 0.3);
    EXPECT_LT(p.y, 4.7);
    EXPECT_GT(std::abs(p.x - 6.0 * std::round(p.x / 6.0)), 0.3) << p.x;
  }
  Ground in_the_air = *ground;
  *in_the_air.height += 1.0;
  EXPECT_FALSE(open_space(model, in_the_air, 1.6)) << "no floor there";
}

}  // namespace
}  // namespace binosplat
