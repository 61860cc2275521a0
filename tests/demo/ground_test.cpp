// The ground that is found in built-in scenes, and in real ones, whose cameras give a better estimate to
// compare with.

#include "scene/ground.h"

#include <gtest/gtest.h>

#include <chrono>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/quaternion.hpp>

#include "demo/demo.h"
#include "formats/cameras/cameras_file.h"
#include "formats/models/model_file.h"
#include "scene/framing.h"
#include "scene/transform.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

/// The orientations of files: y down, z up, and askew.
const std::array<glm::dquat, 3> turns = {glm::dquat(1, 0, 0, 0),
                                         glm::angleAxis(-glm::half_pi<double>(), glm::dvec3(1, 0, 0)),
                                         glm::angleAxis(1.0, glm::normalize(glm::dvec3(1, 2, 3)))};

Model turned(Model model, const glm::dquat& by) {
  std::vector<glm::dvec3> places;
  EXPECT_TRUE(transform(model, glm::mat4_cast(by), places));
  return model;
}

/// Returns the angle in degrees between the up direction that is found and the rotated true one.
double degrees_off_up(const Model& model, const glm::dvec3& up, const glm::dquat& by, bool place) {
  const Model there = turned(model, by);
  const auto begin = std::chrono::steady_clock::now();
  const auto found = find_ground(there);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  EXPECT_TRUE(found);
  if (!found) return 180.0;
  EXPECT_EQ(found->height.has_value(), place);
  const double degrees = glm::degrees(std::acos(std::min(1.0, glm::dot(found->up, by * up))));
  std::printf("%.1f degrees from up, %.2f s\n", degrees, took.count());
  return degrees;
}

TEST(GroundInScenes, MatchesBuiltInScenes) {
  const glm::dvec3 up = default_up;
  const Model room = demo_room().model, city = demo_city({.count = 100'000}).model;
  for (const glm::dquat& by : turns) {
    EXPECT_LT(degrees_off_up(room, up, by, true), 1.0);
    EXPECT_LT(degrees_off_up(city, up, by, true), 1.0);
  }
  // Injected: positions are rotated without the Gaussians' orientations.
  Model torn = room;
  torn.position = turned(room, turns[1]).position;
  const auto found = find_ground(torn);
  EXPECT_TRUE(!found || glm::dot(found->up, turns[1] * up) < 0.9);
}

TEST(GroundInScenes, MatchesCapturedUp) {
  struct Trained {
    const char* name;
    const char* file;
    bool place;
    double degrees;
  };
  // fox has two walls and no floor, and its photos were held askew. The up of garden's cameras is 28 degrees
  // from -y.
  for (const Trained& scene :
       {Trained{"fox", "fox.ply", false, 15.0}, Trained{"fox", "fox_pruned.ply", false, 15.0},
        Trained{"garden", "garden.ply", true, 5.0}}) {
    REQUIRE_SCENE(scene.name, folder);
    const Model model = load_model(folder / scene.file);
    const auto capture = capture_of(load_cameras(folder / "cameras.json"));
    ASSERT_TRUE(capture);
    EXPECT_LT(degrees_off_up(model, capture->up, turns[2], scene.place), scene.degrees) << scene.file;
  }
}

TEST(GroundInScenes, CameraStandsInGarden) {
  REQUIRE_SCENE("garden", folder);
  const Model model = load_model(folder / "garden.ply");
  const std::vector<Camera> cameras = load_cameras(folder / "cameras.json");
  // The generated camera stands like the real ones: around the table, above the lawn and below the trees.
  const glm::dvec3 table = capture_of(cameras)->around->middle;
  const Camera camera = frame_model(model, 640, 360);
  EXPECT_LT(glm::distance(camera.position, table), 5.0);
  EXPECT_GT(glm::dot(camera.rotation[2], glm::normalize(table - camera.position)), 0.85);
}

}  // namespace
}  // namespace binosplat
