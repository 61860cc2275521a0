// What a view shows of the parts of a model.
#include "study/seen_parts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/support.h"
#include "scene/reduce.h"

namespace binosplat::study {
namespace {

constexpr int side = 64;
constexpr double focal = 90.0;  // px

/// A wall 2 units ahead, balls in front of it and behind it, and one behind the eye.
Model scene() {
  Model model;
  test::add(model, {0, 0, 3}, glm::vec3(0.1f), 0.9f);
  test::add(model, {0, 0, 2}, glm::vec3(3000.0f, 3000.0f, 0.01f), 0.75f);
  test::add(model, {0, 0, 1}, glm::vec3(0.05f), 0.5f);
  test::add(model, {0, 0, -1}, glm::vec3(0.05f), 0.5f);
  return model;
}

/// With the Gaussians at these indices as parts.
std::vector<SeenPart> seen(const std::vector<std::vector<std::uint32_t>>& indices) {
  Model model;
  ModelParts parts(indices.size());
  for (std::size_t p = 0; p < indices.size(); ++p) parts.replace(model, p, with_order(scene(), indices[p]));
  render::LinearBlend blend(test::gl_context(), model);
  const shared::View view = make_view(test::front_camera(side, side, focal));
  return seen_parts(blend, model, parts, view, {});
}

double of_ball(double opacity, double deviation_px) {
  return opacity * 2.0 * std::numbers::pi * (deviation_px * deviation_px + KERNEL_PX2);
}

TEST(SeenParts, AreLessBehindOthers) {
  const auto parts = seen({{0}, {1}, {2}, {3}, {}});
  ASSERT_EQ(parts.size(), 5u);
  const double front = of_ball(0.5, 0.05 * focal), behind = of_ball(0.9, 0.1 * focal / 3.0) / 16.0;
  EXPECT_NEAR(parts[2].area, front, 0.05 * front);
  EXPECT_NEAR(parts[2].distance, 1.0, 1e-5);
  // A quarter of the light passes the wall, and a quarter of that counts; the ball before it takes some more.
  EXPECT_LT(parts[0].area, behind);
  EXPECT_GT(parts[0].area, 0.2 * behind);
  EXPECT_NEAR(parts[0].distance, 3.0, 1e-5);
  EXPECT_GT(parts[1].area, 0.75 * side * side - 2.0 * front);
  EXPECT_LT(parts[1].area, 0.75 * side * side);
  for (const std::size_t none : {3u, 4u}) EXPECT_EQ(parts[none].area, 0.0);
}

TEST(SeenParts, AreSumsAndMeans) {
  const auto alone = seen({{0}, {1}, {2}, {3}});
  const auto both = seen({{0}, {2, 3}, {1}});
  EXPECT_EQ(both[0].area, alone[0].area);
  EXPECT_EQ(both[1].area, alone[2].area + alone[3].area);
  EXPECT_EQ(both[2].area, alone[1].area) << "in whatever order they lie";
  const auto all = seen({{0, 1, 2, 3}});
  double area = 0.0, logarithm = 0.0;
  for (const SeenPart& part : alone) {
    area += part.area;
    if (part.area > 0.0) logarithm += part.area * std::log(part.distance);
  }
  EXPECT_NEAR(all[0].area, area, 1e-9);
  EXPECT_NEAR(all[0].distance, std::exp(logarithm / area), 1e-6);
}

}  // namespace
}  // namespace binosplat::study
