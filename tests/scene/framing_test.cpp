#include "scene/framing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "base/error.h"
#include "support/models.h"

namespace binosplat {
namespace {

void add_ball(Model& model, const glm::vec3& position, float size) {
  test::add(model, position, glm::vec3(size), 0.9f);
}

/// Returns a ball of Gaussians, evenly spread (Fibonacci spiral), so that their median is its centre.
Model ball_around(const glm::vec3& centre, float radius, int count = 5000) {
  Model model;
  for (int i = 0; i < count; ++i) {
    const double y = 1.0 - 2.0 * (i + 0.5) / count, ring = std::sqrt(1.0 - y * y), angle = 2.399963 * i;
    add_ball(model,
             centre + radius * glm::vec3(glm::dvec3(ring * std::cos(angle), y, ring * std::sin(angle))),
             0.02f * radius);
  }
  return model;
}

/// Returns the largest distance of a Gaussian from the picture's middle, relative to half of the picture's
/// height; infinity if one is behind the near plane.
double reach(const Model& model, const Camera& camera, double near_plane) {
  double out = 0.0;
  for (const glm::vec3& p : model.position) {
    const glm::dvec3 v = glm::transpose(camera.rotation) * (glm::dvec3(p) - camera.position);
    if (v.z < near_plane) return INFINITY;
    out = std::max(out, std::hypot(v.x, v.y) / v.z * camera.fy / (0.5 * camera.height));
  }
  return out;
}

TEST(Framing, BallFillsPicture) {
  for (const float radius : {0.01f, 1.0f, 500.0f}) {
    for (const glm::dvec2 size : {glm::dvec2(640, 360), glm::dvec2(360, 640)}) {
      const Model model = ball_around(radius * glm::vec3(3, -2, 7), radius);
      const Camera camera = frame_model(model, static_cast<int>(size.x), static_cast<int>(size.y));
      const double filled = reach(model, camera, near_plane_for(model));
      const double fits = std::min(1.0, size.x / size.y);
      EXPECT_GT(filled, 0.7 * fits) << radius;
      EXPECT_LT(filled, 1.05 * fits) << radius;
    }
  }
}

TEST(Framing, OutliersChangeNothing) {
  const Model clean = ball_around({0, 0, 0}, 1.0f);
  Model dirty = clean;
  for (int i = 0; i < 100; ++i) add_ball(dirty, glm::vec3(1e4f * static_cast<float>(i), -3e5f, 1e6f), 10.0f);
  const Camera a = frame_model(clean, 640, 360), b = frame_model(dirty, 640, 360);
  EXPECT_LT(glm::length(a.position - b.position), 0.15);
  Model moved = clean;  // injected
  for (glm::vec3& p : moved.position) p.x += 0.3f;
  EXPECT_GT(glm::length(a.position - frame_model(moved, 640, 360).position), 0.15);
}

TEST(Framing, LooksFromAbovePastObstacles) {
  Model model = ball_around({0, 0, 0}, 1.0f);
  const Camera open = frame_model(model, 640, 360);
  EXPECT_LT(open.position.y, -0.2) << "up is negative y";
  EXPECT_NEAR(open.rotation[0].y, 0.0, 1e-9) << "upright";
  const Camera other_up = frame_model(model, 640, 360, 60.0, glm::dvec3(0, 0, 1));
  EXPECT_GT(other_up.position.z, 0.2);
  EXPECT_LT(other_up.rotation[1].z, -0.9) << "the camera's y axis points down";
  const auto blocked_by = [&](const glm::dvec3& at) {
    Model copy = model;
    for (int i = 0; i < 50; ++i)
      add_ball(copy, glm::vec3(at) + 0.01f * static_cast<float>(i) * glm::vec3(1, 0, 0), 0.3f);
    return frame_model(copy, 640, 360);
  };
  const glm::dvec3 wall = 0.75 * open.position;
  const Camera moved = blocked_by(wall);
  EXPECT_GT(glm::length(moved.position - open.position), 0.5);
  EXPECT_GT(glm::length(moved.position - wall), 0.5);
}

TEST(Framing, OrbitGoesAround) {
  const Model model = ball_around({1, 2, 3}, 1.0f);
  const Camera framed = frame_model(model, 640, 360);
  const std::vector<Camera> cameras = orbit(find_viewpoint(model, shape_of(framed)).capture, 12, 640, 360);
  ASSERT_EQ(cameras.size(), 12u);
  EXPECT_EQ(cameras[0].name, "orbit_000");
  EXPECT_EQ(cameras[11].name, "orbit_011");
  EXPECT_LT(glm::distance(cameras[0].position, framed.position), 0.2);
  glm::dvec3 middle(0.0);
  for (const Camera& camera : cameras) {
    middle += camera.position / 12.0;
    EXPECT_NEAR(camera.position.y, cameras[0].position.y, 1e-9);
    EXPECT_LT(reach(model, camera, near_plane_for(model)), 1.05);
  }
  EXPECT_LT(glm::length(glm::dvec2(middle.x, middle.z) - glm::dvec2(1, 3)), 0.05);
}

TEST(Framing, NearSuitsSmallModels) {
  EXPECT_EQ(near_plane_for(ball_around({0, 0, 0}, 5.0f)), near_default);
  EXPECT_NEAR(near_plane_for(ball_around({0, 0, 0}, 0.05f)), 0.005, 1e-4);
}

TEST(Framing, CameraStaysNearFarModels) {
  for (const float far : {1e3f, 1e10f, 1e20f, 1e30f}) {
    Model model;
    add_ball(model, {0.0f, far, -far}, 0.1f);
    const Camera camera = frame_model(model, 160, 120, 50.0, glm::dvec3(0, -1, 0));
    EXPECT_GT(glm::length(camera.position - glm::dvec3(0.0, far, -far)), 1e-8 * static_cast<double>(far))
        << far;
    EXPECT_LT(glm::length(camera.position - glm::dvec3(0.0, far, -far)),
              1.0 + 1e-6 * static_cast<double>(far));
  }
}

TEST(Framing, HandlesDegenerateModels) {
  EXPECT_THROW(frame_model(Model{}, 640, 360), Error);
  Model one;
  add_ball(one, {1, 2, 3}, 0.5f);
  const Camera camera = frame_model(one, 640, 360);
  EXPECT_NEAR(glm::length(camera.position - glm::dvec3(1, 2, 3)), 1.0, 1e-6);
  Model two;
  for (const float x : {0.0f, 10.0f}) add_ball(two, {x, 0, 0}, 0.2f);
  const Camera of_both = frame_model(two, 640, 360);
  EXPECT_LT(reach(two, of_both, near_plane_for(two)), 640.0 / 360.0) << "one is beside the picture";
  EXPECT_THROW(frame_model(one, 640, 360, 0.0), Error);
  EXPECT_THROW(frame_model(one, 640, 360, 60.0, glm::dvec3(0, 0, 0)), Error);
}

// Returns cameras on a circle around the axis `up`, 20 degrees above its plane, which look at its middle.
std::vector<Camera> ring_around(const glm::dvec3& middle, const glm::dvec3& up, double distance,
                                double outwards = 1.0) {
  const glm::dvec3 x = glm::normalize(glm::cross(up, glm::dvec3(0.3, 0.5, -0.8))), y = glm::cross(up, x);
  std::vector<Camera> cameras;
  for (int k = 0; k < 7; ++k) {
    const double turn = 2.0 * glm::pi<double>() * k / 7, rise = glm::radians(20.0);
    const glm::dvec3 away = std::cos(rise) * (std::cos(turn) * x + std::sin(turn) * y) + std::sin(rise) * up;
    const glm::dvec3 eye = middle + distance * away;
    cameras.push_back(look_at(eye, eye - outwards * away, up, 50, 64, 48));
  }
  return cameras;
}

TEST(Capture, IsCentreOfCameras) {
  const glm::dvec3 up = glm::normalize(glm::dvec3(0.3, -0.8, 0.4)), middle(3, -2, 7);
  const auto capture = capture_of(ring_around(middle, up, 5.0));
  ASSERT_TRUE(capture && capture->around);
  EXPECT_LT(glm::distance(capture->up, up), 1e-6);
  EXPECT_LT(glm::distance(capture->around->middle, middle), 1e-6);
  EXPECT_NEAR(capture->around->distance, 5.0, 1e-6);
  EXPECT_NEAR(glm::degrees(capture->around->elevation), 20.0, 1e-6);
  // An orbit uses these cameras' positions.
  const Camera first = orbit(*capture, 5, 64, 48, 50)[0];
  EXPECT_LT(glm::distance(first.position, middle + capture->around->first), 1e-6);
  for (const Camera& camera : orbit(*capture, 5, 64, 48, 50)) {
    EXPECT_NEAR(glm::distance(camera.position, middle), 5.0, 1e-6);
    EXPECT_LT(glm::distance(camera.rotation[2], glm::normalize(middle - camera.position)), 1e-6);
  }
}

TEST(Capture, OneSidedCaptureIsLevel) {
  // Three of the seven cameras, which all look down: their mean up leans back by most of that angle.
  const glm::dvec3 up(0, -1, 0);
  std::vector<Camera> cameras = ring_around({0, 0, 0}, up, 5.0);
  cameras.resize(3);
  const auto capture = capture_of(cameras);
  ASSERT_TRUE(capture);
  EXPECT_GT(glm::dot(capture->up, up), std::cos(glm::radians(2.0)));
  glm::dvec3 mean{0.0};
  for (const Camera& camera : cameras) mean -= camera.rotation[1];
  EXPECT_LT(glm::dot(glm::normalize(mean), up), std::cos(glm::radians(8.0)));
}

TEST(Capture, NeedsConvergingAxes) {
  const auto outwards = capture_of(ring_around({0, 0, 0}, {0, -1, 0}, 5.0, -1.0));
  ASSERT_TRUE(outwards);
  EXPECT_FALSE(outwards->around);
  std::vector<Camera> parallel(5, look_at({0, 0, 0}, {0, 0, 1}, {0, -1, 0}, 50, 64, 48));
  for (int k = 0; k < 5; ++k) parallel[static_cast<std::size_t>(k)].position.x = k;
  ASSERT_TRUE(capture_of(parallel));
  EXPECT_FALSE(capture_of(parallel)->around);
}

TEST(Capture, NeedsCommonUp) {
  EXPECT_FALSE(capture_of({}));
  std::vector<Camera> rolled;
  for (int k = 0; k < 4; ++k) {
    const double roll = 0.5 * glm::pi<double>() * k;
    rolled.push_back(look_at({0, 0, 0}, {0, 0, 1}, {std::sin(roll), -std::cos(roll), 0}, 50, 64, 48));
  }
  EXPECT_FALSE(capture_of(rolled));
}

}  // namespace
}  // namespace binosplat
