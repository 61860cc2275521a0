#include "reference/project.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/models.h"

namespace binosplat::reference {
namespace {

using test::add;
using test::front_camera;

/// Returns a view of 101 x 101 px, so that the axis meets the centre of pixel (50, 50), with a focal length
/// of 100 px.
shared::View front_view() { return make_view(front_camera(101, 101, 100.0)); }

Splat project_one(const glm::vec3& position, const glm::vec3& scale, const glm::vec4& rotation = {1, 0, 0, 0},
                  const shared::View& view = front_view()) {
  Model model;
  add(model, position, scale, 0.75f, {0.25f, 0.5f, 1.5f}, rotation);
  return project(model, 0, view);
}

void expect_near(const glm::dvec3& got, const glm::dvec3& wanted, double bound) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(got[i], wanted[i], bound) << "component " << i;
}

TEST(Project, ProjectsGaussianOnAxis) {
  const Splat splat = project_one({0, 0, 5}, {0.1f, 0.2f, 0.3f});
  ASSERT_TRUE(splat.drawn);
  EXPECT_DOUBLE_EQ(splat.mean.x, 50.0);
  EXPECT_DOUBLE_EQ(splat.mean.y, 50.0);
  EXPECT_EQ(splat.depth, 5.0);
  EXPECT_EQ(splat.opacity, 0.75);
  // A world unit is 20 px wide: the variances are (20 * 0.1)^2 + 0.3 and (20 * 0.2)^2 + 0.3.
  expect_near(splat.covariance, {4.3, 0.0, 16.3}, 1e-6);
  EXPECT_NEAR(splat.det, 4.3 * 16.3, 1e-5);
  expect_near(splat.conic, {1 / 4.3, 0.0, 1 / 16.3}, 1e-7);
  expect_near(splat.colour, {0.25, 0.5, 1.5}, 1e-6);
}

TEST(Project, QuaternionsAreHamiltonWXYZ) {
  // 90 degrees about z swap the axes. 30 degrees turn x towards y, so xy is positive (y is down in world and
  // picture).
  const float s = std::sqrt(0.5f);
  expect_near(project_one({0, 0, 5}, {0.1f, 0.2f, 0.3f}, {s, 0, 0, s}).covariance, {16.3, 0.0, 4.3}, 1e-5);
  const double c = std::cos(M_PI / 6), n = std::sin(M_PI / 6);
  const glm::vec4 turn(std::cos(M_PI / 12), 0, 0, std::sin(M_PI / 12));
  const Splat splat = project_one({0, 0, 5}, {0.2f, 0.1f, 0.3f}, turn);
  expect_near(splat.covariance, {16 * c * c + 4 * n * n + 0.3, 12 * c * n, 16 * n * n + 4 * c * c + 0.3},
              1e-5);
}

TEST(Project, OffAxisDepthWidensSplat) {
  // A needle along z at x / z = 0.2: its ends project to different x. dx/dz = -fx x / z^2 = -4 px a unit.
  const Splat splat = project_one({1, 0, 5}, {0, 0, 0.5f});
  EXPECT_NEAR(splat.mean.x, 50.0 + 100.0 / 5.0, 1e-12);
  expect_near(splat.covariance, {4.0 + 0.3, 0.0, 0.3}, 1e-12);
}

TEST(Project, MatchesFiniteDifferences) {
  Camera camera = look_at({3, -2, 1}, {0.4, 0.3, 0.2}, {0.1, -1, 0.2}, 50, 120, 90);
  camera.fx *= 1.2;
  camera.cx = 47.25;
  const glm::dvec3 centre(0.5, 0.25, 0.125);
  const glm::vec4 rotation(0.3f, -0.5f, 0.2f, 0.7f);
  const glm::dvec3 scale(0.0625, 0.25, 0.125);
  const Splat splat = project_one(centre, scale, rotation, make_view(camera));
  ASSERT_TRUE(splat.drawn);

  const auto projected = [&](const glm::dvec3& p) {
    const glm::dvec3 v = glm::transpose(camera.rotation) * (p - camera.position);
    return glm::dvec2(camera.fx * v.x / v.z + camera.cx - 0.5, camera.fy * v.y / v.z + camera.cy - 0.5);
  };
  // q v q* is the rotation of a unit quaternion q. Each axis of the Gaussian adds its outer product.
  const glm::dvec4 q = glm::normalize(glm::dvec4(rotation));
  const glm::dvec3 u(q[1], q[2], q[3]);
  glm::dvec3 c2(0.3, 0.0, 0.3);
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 e(0.0);
    e[axis] = 1.0;
    const glm::dvec3 turned = e + 2.0 * glm::cross(u, glm::cross(u, e) + q[0] * e);
    const double h = 1e-5;
    const glm::dvec2 step =
        (projected(centre + h * turned) - projected(centre - h * turned)) / (2 * h) * scale[axis];
    c2 += glm::dvec3(step.x * step.x, step.x * step.y, step.y * step.y);
  }
  expect_near(splat.covariance, c2, 1e-4);
  EXPECT_NEAR(splat.mean.x, projected(centre).x, 1e-4);
  EXPECT_NEAR(splat.mean.y, projected(centre).y, 1e-4);
}

TEST(Project, CullsUpToNearPlane) {
  shared::View view = make_view(front_camera(101, 101, 100.0), 0.25);
  const float beyond = std::nextafter(0.25f, 1.0f);
  EXPECT_FALSE(project_one({0, 0, 0.25f}, glm::vec3(0.01f), {1, 0, 0, 0}, view).drawn);
  EXPECT_TRUE(project_one({0, 0, beyond}, glm::vec3(0.01f), {1, 0, 0, 0}, view).drawn);
  EXPECT_FALSE(project_one({0, 0, -3}, glm::vec3(0.01f), {1, 0, 0, 0}, view).drawn);
  EXPECT_FALSE(project_one({0, 0, 0.2f}, glm::vec3(0.01f)).drawn);
  EXPECT_TRUE(project_one({0, 0, std::nextafter(0.2f, 1.0f)}, glm::vec3(0.01f)).drawn);
}

TEST(Project, ClampsPerspectivePerSide) {
  Camera camera = front_camera(100, 80, 100.0);
  camera.cx = 20;  // the clamp: -(20 + 15) / 100 to (100 - 20 + 15) / 100
  camera.cy = 50;  // and -(50 + 12) / 100 to (80 - 50 + 12) / 100
  const shared::View view = make_view(camera);
  // A needle along z: C2.xx - 0.3 is (fx t.x / z^2 * scale)^2, here at z = 2 with scale 0.5: (25 t.x /
  // t.z)^2.
  const auto slope = [&](double x_over_z, double y_over_z) {
    const Splat splat = project_one({2 * x_over_z, 2 * y_over_z, 2}, {0, 0, 0.5f}, {1, 0, 0, 0}, view);
    return glm::dvec2(std::sqrt(splat.covariance.x - 0.3), std::sqrt(splat.covariance.z - 0.3)) / 25.0;
  };
  EXPECT_NEAR(slope(0.9375, 0).x, 0.9375, 1e-6);
  EXPECT_NEAR(slope(1.25, 0).x, 0.95, 1e-6);
  EXPECT_NEAR(slope(-0.3125, 0).x, 0.3125, 1e-6);
  EXPECT_NEAR(slope(-0.5, 0).x, 0.35, 1e-6);
  EXPECT_NEAR(slope(0, 0.5).y, 0.42, 1e-6);
  EXPECT_NEAR(slope(0, -0.75).y, 0.62, 1e-6);
  // The mean itself is not clamped.
  EXPECT_NEAR(project_one({2.5f, 0, 2}, {0, 0, 0.5f}, {1, 0, 0, 0}, view).mean.x, 125 + 20 - 0.5, 1e-9);
  // A centred principal point gives 3D-GS' 1.3 W / (2 fx).
  const shared::View centred = make_view(front_camera(100, 80, 100.0));
  const Splat splat = project_one({2, 0, 2}, {0, 0, 0.5f}, {1, 0, 0, 0}, centred);
  EXPECT_NEAR(std::sqrt(splat.covariance.x - 0.3) / 25.0, 1.3 * 100 / (2 * 100.0), 1e-6);
}

TEST(Project, ZeroSizeGivesLowPass) {
  const Splat splat = project_one({0, 0, 5}, {0, 0, 0});
  ASSERT_TRUE(splat.drawn);
  expect_near(splat.covariance, {0.3, 0.0, 0.3}, 0.0);
}

// docs/method.md 2: the low-pass lowers the peak and keeps the mass: sigma sqrt(det P / det C2).
TEST(Project, AntialiasingKeepsMass) {
  Model model;
  add(model, {0, 0, 5}, {0.1f, 0.2f, 0.3f}, 0.75f);
  add(model, {0, 0, 5}, {0.1f, 0.0f, 0.3f}, 0.75f);  // seen edge-on: vanishes
  model.kernel_px2 = 0.1;
  EXPECT_EQ(project(model, 0, front_view()).opacity, 0.75);  // not if the model is not antialiased
  model.antialiased = true;
  const Splat splat = project(model, 0, front_view());
  expect_near(splat.covariance, {4.1, 0.0, 16.1}, 1e-6);
  EXPECT_NEAR(splat.opacity, 0.75 * std::sqrt(4.0 * 16.0 / (4.1 * 16.1)), 1e-7);
  EXPECT_EQ(project(model, 1, front_view()).opacity, 0.0);
}

// gsplat_test.cpp tests each coefficient of degree 3.
TEST(Project, LowerDegreesTruncateDegreeThree) {
  const Model whole = test::random_model(8, 50, 3);
  const shared::View view = make_view(front_camera(64, 64, 64.0));
  for (int degree = 0; degree <= 2; ++degree) {
    Model lower = whole, zeros = whole;
    const std::size_t values = 3 * static_cast<std::size_t>(sh_count(degree));
    lower.degree = degree;
    lower.sh.resize(values * whole.count());
    for (std::size_t i = 0; i < whole.count(); ++i) {
      std::copy_n(&whole.sh[48 * i], values, &lower.sh[values * i]);
      std::fill(&zeros.sh[48 * i] + values, &zeros.sh[48 * i] + 48, 0.0f);
    }
    int different = 0;
    for (std::size_t i = 0; i < whole.count(); ++i) {
      EXPECT_EQ(project(lower, i, view).colour, project(zeros, i, view).colour) << degree;
      different += project(lower, i, view).colour != project(whole, i, view).colour ? 1 : 0;
    }
    EXPECT_GT(different, 40) << "injected: the coefficients beyond";
  }
}

TEST(Project, ColourUsesEyeToGaussianDirection) {
  // Coefficient 3 is -C1 x: a Gaussian to the right of the eye is darker, at any position of eye and anchor.
  Model model;
  model.degree = 1;
  add(model, {11, 0, 0}, glm::vec3(0.1f), 0.5f, glm::vec3(0.5f));
  model.sh[9] = 0.5f;
  Camera camera = front_camera(64, 64, 20);
  camera.position = {10, 0, -1};
  const double wanted = 0.5 - 0.4886025119029199 * std::sqrt(0.5) * 0.5;
  EXPECT_NEAR(project(model, 0, make_view(camera)).colour.r, wanted, 1e-7);
  EXPECT_NEAR(project(model, 0, make_view(camera, glm::vec3(9.5f, 1, 2), near_default)).colour.r, wanted,
              1e-6);
}

TEST(Project, ColourIsClampedBelowOnly) {
  Model model;
  add(model, {0, 0, 5}, glm::vec3(0.1f), 0.5f, {-0.5f, 0.5f, 2.5f});
  expect_near(project(model, 0, front_view()).colour, {0.0, 0.5, 2.5}, 1e-6);
}

TEST(Project, ProjectAllEqualsEach) {
  const Model model = test::random_model(7, 500, 3);
  const shared::View view = make_view(front_camera(64, 64, 64.0));
  const std::vector<Splat> splats = project_all(model, view);
  ASSERT_EQ(splats.size(), 500u);
  int drawn = 0;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    EXPECT_EQ(splats[i].mean, project(model, i, view).mean);
    drawn += splats[i].drawn;
  }
  EXPECT_GT(drawn, 450);
  EXPECT_LT(drawn, 500);
}

}  // namespace
}  // namespace binosplat::reference
