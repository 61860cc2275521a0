#include "demo/room.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/round_trip.h"

namespace binosplat {
namespace {

const Demo& room() {
  static const Demo demo = demo_room();
  return demo;
}

TEST(DemoRoom, IsTheSameEveryTime) {
  Model again = demo_room().model;
  EXPECT_TRUE(test::same_bits(room().model, again));
  again.sh.back() = std::nextafter(again.sh.back(), 1.0f);
  EXPECT_FALSE(test::same_bits(room().model, again)) << "a difference in the last bit goes unnoticed";
}

TEST(DemoRoom, IsAsLargeAsPromised) {
  const Model& m = room().model;
  EXPECT_EQ(m.name, "demo:room");
  EXPECT_GE(m.count(), 60000u);
  EXPECT_LE(m.count(), 100000u);
  EXPECT_EQ(m.degree, 3);
  EXPECT_EQ(m.left_out, 0u);
  EXPECT_EQ(m.scale.size(), m.count());
  EXPECT_EQ(m.rotation.size(), m.count());
  EXPECT_EQ(m.opacity.size(), m.count());
  EXPECT_EQ(m.sh.size(), m.count() * 3 * static_cast<std::size_t>(sh_count(m.degree)));
}

TEST(DemoRoom, EveryValueIsSound) {
  const Model& m = room().model;
  for (std::size_t i = 0; i < m.count(); ++i) {
    ASSERT_TRUE(std::isfinite(glm::length(m.position[i]))) << i;
    const glm::vec3 s = m.scale[i];
    ASSERT_TRUE(std::min({s.x, s.y, s.z}) > 0.0f && std::max({s.x, s.y, s.z}) < 100.0f) << i;
    ASSERT_NEAR(glm::length(m.rotation[i]), 1.0f, 1e-5f) << i;
    ASSERT_TRUE(m.opacity[i] > 0.0f && m.opacity[i] <= 0.99f) << i;
  }
  for (const float v : m.sh) ASSERT_LT(std::abs(v), 20.0f);
}

TEST(DemoRoom, HasWhatAStereoRendererMustShow) {
  const Model& m = room().model;
  std::size_t thin = 0, translucent = 0, view_dependent = 0;
  const auto coefficients = static_cast<std::size_t>(sh_count(m.degree));
  for (std::size_t i = 0; i < m.count(); ++i) {
    glm::vec3 s = m.scale[i];
    std::sort(&s.x, &s.x + 3);
    thin += s.z > 3.0f * s.y && s.y < 0.005f;
    translucent += m.opacity[i] < 0.3f;
    float beyond = 0.0f;
    for (std::size_t k = 12; k < 3 * coefficients; ++k) {
      beyond = std::max(beyond, std::abs(m.sh[3 * coefficients * i + k]));
    }
    view_dependent += beyond > 0.01f;
  }
  EXPECT_GT(thin, 1000u) << "wires";
  EXPECT_GT(translucent, 500u) << "glass";
  EXPECT_GT(view_dependent, 10000u) << "degree 2 and 3 in use";
}

TEST(DemoRoom, ReachesFromTheArmToTheHills) {
  const Model& m = room().model;
  ASSERT_GE(room().cameras.size(), 3u);
  const Camera& camera = room().cameras[0];
  const shared::View view = make_view(camera);
  float nearest = 1e9f, farthest = 0.0f;
  for (const glm::vec3& p : m.position) {
    const glm::vec3 d = p - glm::vec3(view.anchor);
    const auto row = [&](const glm::vec4& r) { return glm::dot(glm::vec3(r), d) + r.w; };
    const glm::vec3 v(row(view.row_x), row(view.row_y), row(view.row_z));
    if (v.z < near_default) continue;
    const double x = camera.fx * v.x / v.z + camera.cx, y = camera.fy * v.y / v.z + camera.cy;
    if (x < 0 || y < 0 || x > camera.width || y > camera.height) continue;
    nearest = std::min(nearest, glm::length(v));
    farthest = std::max(farthest, v.z);
  }
  EXPECT_GT(nearest, 0.3f);
  EXPECT_LT(nearest, 0.6f);
  EXPECT_GT(farthest, 100.0f);
}

TEST(DemoRoom, CamerasAreNamedHeads) {
  for (std::size_t i = 0; i < room().cameras.size(); ++i) {
    const Camera& camera = room().cameras[i];
    EXPECT_EQ(camera.width, 1280);
    EXPECT_EQ(camera.height, 720);
    EXPECT_FALSE(camera.name.empty());
    for (std::size_t k = 0; k < i; ++k) EXPECT_NE(camera.name, room().cameras[k].name);
    // Upright: the picture's right is level with the floor.
    EXPECT_NEAR(camera.rotation[0].y, 0.0, 1e-12);
    EXPECT_GT(camera.rotation[1].y, 0.8);
  }
}

}  // namespace
}  // namespace binosplat
