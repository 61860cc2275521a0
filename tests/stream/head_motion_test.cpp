// Predicts the motion of a head.

#include "stream/head_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "scene/camera.h"

namespace binosplat {
namespace {

using Views = std::vector<shared::View>;

// Returns both eyes of a head at a time in s. From 0 on it moves and rotates at constant speed.
Views head_at(double time, const glm::dvec3& speed, double turn) {
  const double t = std::max(time, 0.0);
  const glm::dvec3 at = glm::dvec3(3, -2, 7) + t * speed;
  const glm::dvec3 ahead(std::sin(turn * t), 0.1, std::cos(turn * t));
  Views views;
  for (const double side : {-0.03, 0.03}) {
    Camera eye = look_at(at, at + ahead, {0, -1, 0}, 90, 640, 480);
    eye.position += side * eye.rotation[0];
    views.push_back(make_view(eye, glm::vec3(at), 0.2));
  }
  return views;
}

Clock::time_point moment(double seconds) {
  return Clock::time_point{} +
         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

// Returns the largest difference of two views, in world units or units of directions, whatever their anchors
// are.
double apart(const shared::View& a, const shared::View& b) {
  const auto eye = [](const shared::View& view) { return glm::dvec3(view.anchor) + glm::dvec3(view.eye); };
  double most = glm::distance(eye(a), eye(b));
  for (const auto row : {&shared::View::row_x, &shared::View::row_y, &shared::View::row_z}) {
    most = std::max<double>(most, glm::distance(glm::vec3(a.*row), glm::vec3(b.*row)));
    // A point's position in the camera's frame, computed with either anchor.
    const auto place = [&](const shared::View& view) {
      return glm::dot(glm::dvec3(view.*row), glm::dvec3(9, 8, 7) - glm::dvec3(view.anchor)) + (view.*row).w;
    };
    most = std::max(most, std::abs(place(a) - place(b)) / 10.0);
  }
  return most;
}

TEST(HeadMotion, ExtrapolatesMotion) {
  const glm::dvec3 speed(2.0, 0.5, -1.0);
  HeadMotion motion;
  for (int n = 0; n <= 60; ++n) motion.note(head_at(n / 90.0, speed, 1.0), moment(n / 90.0));
  const Views now = head_at(60 / 90.0, speed, 1.0), then = head_at(60 / 90.0 + 0.3, speed, 1.0);
  for (std::size_t v = 0; v < 2; ++v) {
    EXPECT_LT(apart(motion.predicted(0.3)[v], then[v]), 0.012) << v;
    EXPECT_GT(apart(motion.predicted(0.2)[v], then[v]), 0.1) << "injected: not far enough";
    EXPECT_LT(apart(motion.predicted(0.0)[v], now[v]), 1e-5);
  }
}

TEST(HeadMotion, RestPredictsNoMotion) {
  const Views still = head_at(0.0, {}, 0.0);
  HeadMotion motion;
  for (int n = 0; n <= 60; ++n) motion.note(still, moment(n / 90.0));
  const auto bytes = [](const Views& views) { return std::as_bytes(std::span(views)); };
  EXPECT_TRUE(std::ranges::equal(bytes(motion.predicted(0.3)), bytes(still)));
}

TEST(HeadMotion, StopEndsMotion) {
  const glm::dvec3 speed(2.0, 0.0, 0.0);
  HeadMotion motion;
  for (int n = -40; n <= 40; ++n) {
    const double time = std::min(n, 20) / 90.0;
    motion.note(head_at(time, speed, 1.0), moment(n / 90.0));
  }
  const Views rest = head_at(20 / 90.0, speed, 1.0);
  EXPECT_EQ(apart(motion.predicted(0.3)[0], rest[0]), 0.0);
}

TEST(HeadMotion, IgnoresJumps) {
  HeadMotion motion;
  Views views;
  for (int n = 0; n <= 90; ++n) {
    views = head_at(n < 45 ? 0.0 : 5.0, {4.0, 0.0, 0.0}, 0.3);
    motion.note(views, moment(n / 90.0));
    ASSERT_EQ(apart(motion.predicted(0.3)[0], views[0]), 0.0) << n;
  }
}

TEST(HeadMotion, NeedsFrequentFrames) {
  HeadMotion motion;
  Views views;
  for (int n = 0; n <= 10; ++n) motion.note(views = head_at(n * 0.4, {1.0, 0.0, 0.0}, 0.1), moment(n * 0.4));
  EXPECT_EQ(apart(motion.predicted(0.3)[0], views[0]), 0.0);
}

}  // namespace
}  // namespace binosplat
