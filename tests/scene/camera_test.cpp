#include "scene/camera.h"

#include <gtest/gtest.h>

#include <algorithm>

#include <cmath>

#include "base/error.h"
#include "scene/model.h"
#include "support/models.h"

namespace binosplat {
namespace {

glm::dvec2 pixel(const shared::View& view, const glm::vec3& p) {
  const glm::vec3 d = p - glm::vec3(view.anchor);
  const auto row = [&](const glm::vec4& r) { return static_cast<double>(glm::dot(glm::vec3(r), d) + r.w); };
  const double z = row(view.row_z);
  return {view.lens.x * row(view.row_x) / z + view.lens.z - 0.5,
          view.lens.y * row(view.row_y) / z + view.lens.w - 0.5};
}

TEST(Camera, LookAtCentresPoint) {
  const Camera camera = look_at({1, -2, 3}, {0, 0, 10}, {0, -1, 0}, 60.0, 640, 360);
  EXPECT_NEAR(glm::determinant(camera.rotation), 1.0, 1e-12);
  const shared::View view = make_view(camera);
  EXPECT_LT(glm::length(pixel(view, {0, 0, 10}) - glm::dvec2(319.5, 179.5)), 1e-3);
  EXPECT_LT(pixel(view, {0, -1, 10}).y, 170.0) << "towards up is towards the top row";
  EXPECT_GT(pixel(view, {1, 0, 10}).x, 330.0) << "x stays to the right for a camera that looks along z";
  // The field of view is vertical: its edge is the picture's edge.
  const glm::dvec3 edge = camera.position + camera.rotation * glm::dvec3(0, std::tan(glm::radians(30.0)), 1);
  EXPECT_NEAR(pixel(view, glm::vec3(edge)).y, 359.5, 1e-3);
}

TEST(Camera, LookAtRejectsDegenerateInput) {
  const glm::dvec3 up(0, -1, 0);
  EXPECT_THROW(look_at({1, 2, 3}, {1, 2, 3}, up, 60, 64, 64), Error);
  EXPECT_THROW(look_at({0, 0, 0}, {0, 5, 0}, up, 60, 64, 64), Error);
  EXPECT_THROW(look_at({0, 0, 0}, {0, 0, NAN}, up, 60, 64, 64), Error);
  for (const double fov : {0.0, 180.0, -5.0, static_cast<double>(NAN)}) {
    EXPECT_THROW(look_at({0, 0, 0}, {0, 0, 1}, up, fov, 64, 64), Error);
  }
}

TEST(Camera, ResizedKeepsVerticalField) {
  Camera camera = look_at({0, 0, 0}, {0, 0, 1}, {0, -1, 0}, 60.0, 640, 360);
  camera.cx += 32.0;
  const Camera large = resized(camera, 3840, 1080);
  EXPECT_DOUBLE_EQ(large.fy / large.height, camera.fy / camera.height);
  EXPECT_DOUBLE_EQ(large.fx, large.fy);
  EXPECT_DOUBLE_EQ(large.cx, 1920.0 + 96.0) << "off centre by the same angle";
  EXPECT_DOUBLE_EQ(large.cy, 540.0);
}

TEST(Camera, ViewHoldsEyeAndNear) {
  Camera camera = look_at({5, 6, 7}, {0, 0, 10}, {0, -1, 0}, 60.0, 640, 360);
  const shared::View view = make_view(camera, {4, 4, 4}, 0.05);
  EXPECT_EQ(glm::vec3(view.eye), glm::vec3(1, 2, 3));
  EXPECT_EQ(view.anchor, glm::vec4(4, 4, 4, 0.05f));
  EXPECT_EQ(view.width, 640u);
  EXPECT_EQ(view.height, 360u);
  // Another anchor gives the same picture.
  EXPECT_LT(glm::length(pixel(view, {1, 2, 9}) - pixel(make_view(camera), {1, 2, 9})), 2e-3);
  camera.position.x += 0.01;
  EXPECT_GT(glm::length(pixel(view, {1, 2, 9}) - pixel(make_view(camera), {1, 2, 9})), 0.1);
}

TEST(Model, DecodesRawValues) {
  Model model;
  const float sh[3] = {1, 2, 3};
  ASSERT_TRUE(test::append_raw(model, {{1, 2, 3}, {0, std::log(2.0f), -INFINITY}, {2, 0, 0, 0}, 0.0f, sh}));
  EXPECT_EQ(model.scale[0], glm::vec3(1, 2, 0));
  EXPECT_EQ(model.rotation[0], glm::vec4(1, 0, 0, 0));
  EXPECT_EQ(model.opacity[0], 0.5f);
  ASSERT_TRUE(test::append_raw(model, {{1, 2, 3}, {0, 0, 0}, {0, 0, 3e30f, 4e30f}, INFINITY, sh}));
  EXPECT_LT(glm::length(model.rotation[1] - glm::vec4(0, 0, 0.6f, 0.8f)), 1e-6f)
      << "its squares overflow fp32";
  EXPECT_EQ(model.opacity[1], 1.0f);
  EXPECT_EQ(model.left_out, 0u);
}

TEST(Model, SkipsNonFiniteGaussians) {
  Model model;
  const float sh[3] = {1, 2, 3}, bad_sh[3] = {1, NAN, 3};
  const glm::vec4 q(1, 0, 0, 0);
  EXPECT_FALSE(test::append_raw(model, {{NAN, 0, 0}, {0, 0, 0}, q, 0, sh}));
  EXPECT_FALSE(test::append_raw(model, {{0, 0, 0}, {1000, 0, 0}, q, 0, sh}));
  EXPECT_FALSE(test::append_raw(model, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0, 0}, 0, sh}));
  EXPECT_FALSE(test::append_raw(model, {{0, 0, 0}, {0, 0, 0}, {INFINITY, 0, 0, 0}, 0, sh}));
  EXPECT_FALSE(test::append_raw(model, {{0, 0, 0}, {0, 0, 0}, q, NAN, sh}));
  EXPECT_FALSE(test::append_raw(model, {{0, 0, 0}, {0, 0, 0}, q, 0, bad_sh}));
  EXPECT_EQ(model.left_out, 6u);
  EXPECT_EQ(model.count(), 0u);
  EXPECT_TRUE(test::append_raw(model, {{0, 0, 0}, {0, 0, 0}, q, 0, sh}));
  EXPECT_EQ(model.count(), 1u);
}

TEST(Model, CoreBoundsIgnoreOutliers) {
  Model model;
  model.resize(1001);
  for (int i = 0; i <= 1000; ++i) model.position[static_cast<std::size_t>(i)] = glm::vec3(i, -i, 5);
  model.position[500] = {1e9f, 1e9f, 1e9f};
  const Bounds transparent = core_bounds(model);
  std::fill(model.opacity.begin(), model.opacity.end(), 0.5f);
  const Bounds bounds = core_bounds(model);
  EXPECT_EQ(transparent.high, bounds.high) << "all alike";
  EXPECT_NEAR(bounds.low.x, 20.0f, 1.5f);
  EXPECT_NEAR(bounds.high.x, 980.0f, 1.5f);
  EXPECT_NEAR(bounds.high.y, -20.0f, 1.5f);
  EXPECT_EQ(bounds.low.z, 5.0f);
  for (std::size_t i = 600; i <= 1000; ++i) model.opacity[i] = 0.0f;
  EXPECT_NEAR(core_bounds(model).high.x, 588.0f, 1.5f) << "nobody sees the others";
  EXPECT_EQ(core_bounds(Model{}).high, glm::dvec3(0.0));
}

}  // namespace
}  // namespace binosplat
