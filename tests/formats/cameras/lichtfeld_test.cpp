// Camera paths of LichtFeld Studio.

#include <gtest/gtest.h>

#include <cmath>

#include "scene/key_path.h"
#include "support/load.h"

namespace binosplat {
namespace {

using nlohmann::json;

/// Returns a path as LichtFeld's sequencer saves it. The key that is first in the file is later in time, and
/// turned 90 degrees to the left of the other.
json path_json() {
  const double half = std::sqrt(0.5);
  return {{"version", 4},
          {"clip_duration", 30.0},
          {"keyframes",
           {{{"time", 7.0},
             {"position", {1, 2, 3}},
             {"rotation", {half, 0, half, 0}},
             {"focal_length_mm", 24.0},
             {"easing", 0}},
            {{"time", 5.0},
             {"position", {0, 0, 0}},
             {"rotation", {1, 0, 0, 0}},
             {"focal_length_mm", 12.0},
             {"easing", 0}}}}};
}

std::vector<Camera> load(const json& root) { return test::load_cameras_of(root.dump(), "path.json"); }

bool is_near(const glm::dvec3& a, const glm::dvec3& b) { return glm::distance(a, b) < 1e-12; }

TEST(LichtFeld, ConvertsKeysToModelWorld) {
  const std::vector<Camera> keys = load(path_json());
  ASSERT_EQ(keys.size(), 2u);
  EXPECT_EQ(keys[0].name, "key_000");
  EXPECT_EQ(*keys[0].time, 0.0);
  EXPECT_EQ(*keys[1].time, 2.0);
  // In LichtFeld's world and cameras, y is up and z is backwards. Without a rotation, a camera looks the same
  // way in the model's world.
  EXPECT_EQ(keys[0].rotation, glm::dmat3(1.0));
  EXPECT_EQ(keys[1].position, glm::dvec3(1, -2, -3));
  EXPECT_TRUE(is_near(keys[1].rotation[2], {-1, 0, 0}));  // forward
  EXPECT_TRUE(is_near(keys[1].rotation[1], {0, 1, 0}));   // down
  // The film is 24 mm high. The focal lengths are 24 mm and 12 mm.
  EXPECT_DOUBLE_EQ(keys[1].fy, keys[1].height);
  EXPECT_DOUBLE_EQ(keys[0].fy, 0.5 * keys[0].height);
  EXPECT_TRUE(are_keys(keys));
}

TEST(LichtFeld, ReportsIgnoredKeys) {
  json path = path_json();
  path["keyframes"][0]["easing"] = 3;
  path["animation_clip"] = {{"name", "default"}};
  testing::internal::CaptureStderr();
  load(path);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("easing of its keys is ignored"), std::string::npos);
  EXPECT_NE(said.find("animation_clip is ignored"), std::string::npos);
}

TEST(LichtFeld, ErrorsNameKey) {
  const auto with = [](const std::string& pointer, const json& value) {
    return test::with_value(path_json(), pointer, value);
  };
  const std::string key = "/keyframes/1/";
  const std::vector<test::BrokenFile> refusals = {
      {with("/version", 5), {"key 'version'", "up to version 4 are known"}},
      {with(key + "rotation", nullptr), {"keyframes[1]", "rotation"}},
      {with(key + "rotation", {0, 0, 0, 0}), {"key 'keyframes[1].rotation'", "length 0"}},
      {with(key + "focal_length_mm", 0), {"key 'keyframes[1].focal_length_mm'"}},
      {with(key + "position", {1, 2}), {"keyframes[1].position"}},
  };
  test::expect_no_cameras("bad.json", refusals);
}

}  // namespace
}  // namespace binosplat
