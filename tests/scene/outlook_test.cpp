// How models without cameras are looked at: objects whole, scenes from within, all upright.

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "scene/axes.h"
#include "scene/framing.h"
#include "scene/reduce.h"
#include "support/surfaces.h"

namespace binosplat {
namespace {

using Kind = Viewpoint::Kind;
using test::Surfaces;

constexpr int wide = 640, high = 360;

PictureShape shape_for(int width, int height) {
  return shape_of(look_at({0, 0, 0}, {0, 0, 1}, {0, -1, 0}, default_fov_degrees, width, height));
}

Viewpoint viewpoint(const Model& model, int width = wide, int height = high) {
  return find_viewpoint(model, shape_for(width, height));
}

/// Returns the largest distance of the first `count` Gaussians from the picture's middle: 1 is its edge.
double edge(const Model& model, const Camera& camera, std::size_t count) {
  double out = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 p = into_world(model.position[i], model.axes);
    const glm::dvec3 v = glm::transpose(camera.rotation) * (p - camera.position);
    if (v.z <= 0.0) return INFINITY;
    out = std::max({out, std::abs(v.x) / v.z * camera.fx / (0.5 * camera.width),
                    std::abs(v.y) / v.z * camera.fy / (0.5 * camera.height)});
  }
  return out;
}

/// A closed box around `middle` with these sides; y is down.
void add_box(Surfaces& to, const glm::dvec3& middle, const glm::dvec3& sides, int count) {
  const glm::dvec3 x(sides.x, 0, 0), y(0, sides.y, 0), z(0, 0, sides.z), low = middle - 0.5 * sides;
  for (const glm::dvec3& corner : {low, low + y}) to.add(corner, x, z, count);
  for (const glm::dvec3& corner : {low, low + z}) to.add(corner, x, y, count);
  for (const glm::dvec3& corner : {low, low + x}) to.add(corner, y, z, count);
}

/// A coat: taller than wide.
Model coat() {
  Surfaces out;
  add_box(out, {0.3, -2.0, 1.0}, {1.6, 4.0, 1.2}, 1500);
  return out.model;
}

TEST(Viewpoint, FramesObjectWithoutFloaters) {
  Model model = coat();
  const std::size_t count = model.count();
  test::Uniform uniform(7);
  for (int i = 0; i < 60; ++i) {
    const glm::vec3 far(uniform(-40, 40), uniform(-40, 40), uniform(-40, 40));
    test::add(model, far, glm::vec3(0.1f), 0.9f);
  }
  for (const glm::ivec2 size : {glm::ivec2(640, 360), glm::ivec2(360, 720)}) {
    const Viewpoint found = viewpoint(model, size.x, size.y);
    EXPECT_EQ(found.kind, Kind::whole);
    const Camera camera = first_camera(found.capture, size.x, size.y);
    EXPECT_LT(edge(model, camera, count), 1.0);
    EXPECT_GT(edge(model, camera, count), 0.7) << "floaters make it small";
    for (const Camera& around : orbit(found.capture, 7, size.x, size.y))
      EXPECT_LT(edge(model, around, count), 1.0) << around.name;
    EXPECT_LT(camera.rotation[1].y, 2.0);
    EXPECT_GT(camera.rotation[1].y, 0.9) << "upright";
  }
  // Injected fault: the ball that holds half of the Gaussians.
  const Viewpoint middle = find_viewpoint(model, shape_for(wide, high), {}, 1.6, Kind::core);
  EXPECT_GT(edge(model, first_camera(middle.capture, wide, high), count), 1.0);
}

TEST(Viewpoint, ReliefIsSeenAlongThinAxis) {
  // A photo: x to both sides, y down, and a depth of 0.08. Most of its surfaces face the camera, like a
  // floor.
  Surfaces photo;
  photo.add({-1, -0.56, 0.06}, {2, 0, 0}, {0, 1.12, 0}, 6000);
  photo.add({-0.4, -0.4, 0.0}, {0.8, 0, 0}, {0, 0.8, 0.02}, 2000);
  for (const char* letters : {"RDF", "LUF", "RUB"}) {  // also with a reflection
    Model model = photo.model;
    bring_into_axes(model, letters);
    const Viewpoint found = viewpoint(model);
    EXPECT_EQ(found.kind, Kind::whole) << letters;
    const Camera camera = first_camera(found.capture, wide, high);
    EXPECT_GT(camera.rotation[2].z, 0.999) << letters;
    EXPECT_GT(camera.rotation[1].y, 0.999) << letters;
    EXPECT_LT(edge(model, camera, model.count()), 1.0);
    EXPECT_GT(edge(model, camera, model.count()), 0.6);
  }
}

TEST(Viewpoint, UsesUpOfFile) {
  Model model = coat();
  model.up = glm::dvec3(0, 0, 1);
  EXPECT_EQ(viewpoint(model).capture.up, glm::dvec3(0, 0, 1));
  EXPECT_EQ(find_viewpoint(model, shape_for(wide, high), glm::dvec3(1, 0, 0)).capture.up,
            glm::dvec3(1, 0, 0));
}

/// A figure that lies on a floor, which is tilted by `degrees` against the format's.
Model lying_figure(double degrees) {
  const double turn = glm::radians(degrees);
  const glm::dvec3 x(1, 0, 0), up(0, -std::cos(turn), std::sin(turn)), z = glm::cross(x, up);
  Surfaces out;
  out.add(-1.5 * x - 1.5 * z, 3.0 * x, 3.0 * z, 6000);
  out.add(-0.9 * x - 0.25 * z + 0.3 * up, 1.8 * x, 0.5 * z, 2500);
  for (const double side : {-0.25, 0.25}) out.add(-0.9 * x + side * z, 1.8 * x, 0.3 * up, 1200);
  return out.model;
}

TEST(Viewpoint, NearbyFloorLevelsObject) {
  const Model tilted = lying_figure(20.0);
  const Viewpoint found = viewpoint(tilted);
  EXPECT_EQ(found.kind, Kind::whole);
  EXPECT_TRUE(found.up_by_floor);
  EXPECT_NEAR(found.capture.up.z, std::sin(glm::radians(20.0)), 0.03);
  EXPECT_LT(edge(tilted, first_camera(found.capture, wide, high), tilted.count()), 1.0);
  // What looks like a floor in another direction is a wall, or a photo.
  const Viewpoint other = viewpoint(lying_figure(90.0));
  EXPECT_FALSE(other.up_by_floor);
  EXPECT_EQ(other.capture.up, default_up);
}

TEST(Viewpoint, FloorOfLargeModelSetsUp) {
  const Viewpoint found = viewpoint(test::garden());
  EXPECT_TRUE(found.up_by_floor);
  EXPECT_GT(found.capture.up.z, 0.999);
}

TEST(Viewpoint, RoomIsSeenFromInside) {
  // One room, and three in a row, whose middle lies in a wall.
  for (const int rooms : {1, 3}) {
    Model model = test::furnished_room();
    for (int k = 1; k < rooms; ++k) {
      const Model other = test::furnished_room({6.0 * k, 0, 0});
      append(model, other, 0, other.count());
    }
    const Viewpoint found = viewpoint(model);
    ASSERT_EQ(found.kind, Kind::within) << rooms;
    EXPECT_GT(found.capture.up.z, 0.999);
    EXPECT_NEAR(found.eyes, 1.6, 1e-9);
    // In three rooms the middle lies in a wall: all go round an open place.
    std::vector<Camera> cameras = {first_camera(found.capture, 64, 48)};
    if (rooms == 3) cameras = orbit(found.capture, 8, 64, 48);
    for (const Camera& camera : cameras) {
      const glm::dvec3& p = camera.position;
      EXPECT_NEAR(p.z, 1.6, 0.1);
      EXPECT_GT(p.y, 0.2);
      EXPECT_LT(p.y, 4.8);
      if (rooms == 3) {
        EXPECT_GT(std::abs(p.x - 6.0 * std::round(p.x / 6.0)), 0.2) << p.x;
      }
    }
  }
}

TEST(Viewpoint, StreetIsSeenFromInside) {
  Surfaces street;  // along z, y down, 1.6 m above the ground
  street.add({-4, 1.6, -30}, {8, 0, 0}, {0, 0, 60}, 6000);
  for (const double side : {-4.0, 4.0}) street.add({side, 1.6, -30}, {0, -9, 0}, {0, 0, 60}, 6000);
  const Viewpoint found = viewpoint(street.model);
  ASSERT_EQ(found.kind, Kind::within);
  const Camera camera = first_camera(found.capture, wide, high);
  EXPECT_NEAR(camera.position.y, 0.0, 0.1);
  EXPECT_LT(std::abs(camera.position.x), 3.5) << "between the houses";
  EXPECT_GT(std::abs(camera.rotation[2].z), 0.8) << "along the street";
}

TEST(Viewpoint, NarrowPlaceWithViewIsBetterThanCloset) {
  // Three closets of 1.8 x 1.8 m in the middle, and a corridor on each side; y down, 1.6 m above the floors.
  Surfaces house;
  const auto add_room = [&](const glm::dvec3& corner, double across, double along, int count) {
    const glm::dvec3 x(across, 0, 0), z(0, 0, along), high(0, -2.5, 0);
    house.add(corner, x, z, count);
    for (const glm::dvec3& low : {corner, corner + x}) house.add(low, z, high, count);
    for (const glm::dvec3& low : {corner, corner + z}) house.add(low, x, high, count);
  };
  for (const double z : {-2.9, -0.9, 1.1}) add_room({-0.9, 1.6, z}, 1.8, 1.8, 1500);
  for (const double x : {-3.3, 1.6}) add_room({x, 1.6, -6}, 1.7, 12, 2500);
  const Viewpoint found = viewpoint(house.model);
  ASSERT_EQ(found.kind, Kind::within);
  const Camera camera = first_camera(found.capture, wide, high);
  EXPECT_NEAR(std::abs(camera.position.x), 2.45, 0.7) << "in a corridor";
  EXPECT_GT(std::abs(camera.rotation[2].z), 0.6) << "along it";
}

TEST(Viewpoint, UnboundedModelIsSeenAtCore) {
  test::Uniform uniform(3);
  Model model;
  for (int i = 0; i < 8000; ++i) {
    const double z = uniform(-1, 1), turn = uniform(0, glm::two_pi<double>()), ring = std::sqrt(1 - z * z);
    const double away = i % 2 == 0 ? uniform(0.0, 1.0) : uniform(2.0, 8.0);
    const glm::vec3 place = away * glm::dvec3(ring * std::cos(turn), ring * std::sin(turn), z);
    test::add(model, place, glm::vec3(0.05 * (1.0 + away)), 0.9f);
  }
  EXPECT_EQ(viewpoint(model).kind, Kind::core);
}

TEST(AnySees, RequiresUnobstructedView) {
  Surfaces ball;
  add_box(ball, {0, 0, 0}, {2, 2, 2}, 2000);
  test::add(ball.model, {0, 0, 0}, glm::vec3(0.2f), 0.99f);
  const auto camera = [](const glm::dvec3& eye, const glm::dvec3& at) {
    return look_at(eye, at, {0, -1, 0}, 60.0, 64, 48);
  };
  EXPECT_TRUE(any_camera_sees(std::array{camera({0, 0, -4}, {0, 0, 0})}, ball.model));
  EXPECT_FALSE(any_camera_sees(std::array{camera({0, 0, -4}, {0, 0, -8})}, ball.model)) << "looks away";
  EXPECT_FALSE(any_camera_sees(std::array{camera({0, 0, -0.99}, {0, 0, 5})}, ball.model))
      << "stands in a wall";
  const auto depths = depths_seen(std::vector{camera({0, 0, -4}, {0, 0, 0})}, ball.model);
  ASSERT_TRUE(depths);
  EXPECT_NEAR((*depths)[0], 3.0, 0.1);
  EXPECT_NEAR((*depths)[1], 5.0, 0.1);
}

}  // namespace
}  // namespace binosplat
