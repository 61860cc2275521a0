#include "scene/key_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "support/errors.h"

namespace binosplat {
namespace {

using Cameras = std::vector<Camera>;
/// Returns the camera at a time.
using Way = std::function<Camera(double)>;

Camera key(const glm::dvec3& place, double degrees, double focal, double time) {
  Camera camera{"key", 64, 48, focal, focal, 32.0, 24.0, place};
  camera.rotation =
      glm::mat3_cast(glm::angleAxis(glm::radians(degrees), glm::normalize(glm::dvec3(0.2, 1, 0.1))));
  camera.time = time;
  return camera;
}

/// Returns keys that are uneven in time and place: a turn on the spot, turns of 150 degrees to both sides, a
/// zoom.
Cameras keys() {
  return {key({0, 0, 0}, 0, 50, 2),    key({1, 0, 0}, 30, 50, 3),  key({1, 0.5, 4}, 180, 50, 5),
          key({1, 0.5, 4}, 30, 50, 6), key({-3, 0, 2}, 20, 80, 9), key({-3, 1, 1}, 20, 90, 9.5)};
}

glm::dvec3 turn_between(const Camera& a, const Camera& b) {
  glm::dquat q = glm::quat_cast(glm::transpose(a.rotation) * b.rotation);
  if (q.w < 0.0) q = -q;
  return 2.0 * glm::dvec3(q.x, q.y, q.z);  // for small angles
}

/// Returns the largest jump of velocity, in world units, radians and focal lengths per second.
double jump(const Way& way, double seconds) {
  constexpr double step = 1e-5;
  double out = 0.0;
  for (double t = 0.01; t < seconds - 0.01; t += 0.005) {
    const Camera a = way(t - step), b = way(t), c = way(t + step);
    out = std::max({out, glm::distance(b.position - a.position, c.position - b.position) / step,
                    glm::distance(turn_between(a, b), turn_between(b, c)) / step,
                    std::abs((c.fx - b.fx) - (b.fx - a.fx)) / 50.0 / step});
  }
  return out;
}

TEST(KeyPath, PassesKeysAtTheirTimes) {
  const Cameras set = keys();
  const KeyPath path(set);
  EXPECT_DOUBLE_EQ(path.seconds(), 7.5);
  for (const Camera& wanted : set) {
    const Camera found = path.at(*wanted.time - 2.0);
    EXPECT_LT(glm::distance(found.position, wanted.position), 1e-9);
    EXPECT_LT(glm::length(turn_between(found, wanted)), 1e-7);
    EXPECT_NEAR(found.fx, wanted.fx, 1e-9);
    EXPECT_NEAR(found.cy, wanted.cy, 1e-9);
    // Half a second away the path is elsewhere, so the comparison detects wrong times.
    EXPECT_GT(glm::distance(path.at(*wanted.time - 1.6).position, wanted.position) +
                  glm::length(turn_between(path.at(*wanted.time - 1.6), wanted)),
              *wanted.time < 9.5 ? 0.05 : -1.0);
  }
}

TEST(KeyPath, VelocityIsContinuousAtKeys) {
  const Cameras set = keys();
  const KeyPath by_times(set), even(set, 7.5);
  EXPECT_LT(jump([&](double t) { return by_times.at(t); }, 7.5), 0.01);
  EXPECT_LT(jump([&](double t) { return even.at(t); }, 7.5), 0.01);
  // Injected: straight paths between two keys each do jump.
  const auto straight = [&](double t) {
    std::size_t k = 1;
    while (k + 1 < set.size() && *set[k].time - 2.0 < t) ++k;
    return KeyPath(std::span<const Camera>(set).subspan(k - 1, 2)).at(t + 2.0 - *set[k - 1].time);
  };
  EXPECT_GT(jump(straight, 7.5), 0.5);
}

TEST(KeyPath, DoesNotOvershootKeys) {
  // A rest at one position, then a straight path.
  const Cameras set = {key({0, 0, 0}, 0, 50, 0), key({1, 0, 0}, 0, 50, 1), key({1, 0, 0}, 0, 50, 4),
                       key({9, 0, 0}, 0, 50, 5)};
  const KeyPath path(set);
  double last = 0.0;
  for (double t = 0.0; t <= 5.0; t += 0.01) {
    const Camera camera = path.at(t);
    EXPECT_GE(camera.position.x, last - 1e-9) << t;
    EXPECT_NEAR(camera.position.y, 0.0, 1e-12);
    last = camera.position.x;
  }
  EXPECT_EQ(path.at(-1.0).position, set[0].position);
  EXPECT_EQ(path.at(7.0).position, set[3].position);
}

TEST(KeyPath, TakesShortestRotation) {
  Cameras set;  // their quaternions change sign between 170 and 190 degrees
  for (int k = 0; k < 40; ++k) set.push_back(key({k, 0, 0}, 20.0 * k, 50, k));
  const Cameras frames = frames_of(KeyPath(set), 10.0);
  for (std::size_t k = 1; k < frames.size(); ++k)
    EXPECT_NEAR(glm::length(turn_between(frames[k - 1], frames[k])), glm::radians(2.0), 1e-3) << k;
}

TEST(KeyPath, HandlesHalfTurns) {
  Cameras set;
  for (const double time : {0.0, 1.0, 2.0, 2.21}) {
    set.push_back(key({0, 0, 0}, 0, 50, time));
    set.back().rotation =
        glm::mat3_cast(set.size() % 2 == 1 ? glm::dquat(1, 0, 0, 0) : glm::dquat(0, 0, 1, 0));
  }
  const KeyPath path(set);
  for (int n = 0; n <= 400; ++n)
    EXPECT_NEAR(glm::determinant(path.at(path.seconds() * n / 400).rotation), 1.0, 1e-9) << n;
}

TEST(KeyPath, EvenPaceIgnoresTimes) {
  Cameras set;
  for (int k = 0; k < 6; ++k) set.push_back(key({k * k, 0, 0}, 0, 50, k));
  const auto unevenness = [](const KeyPath& path) {
    double least = INFINITY, most = 0.0;
    const Cameras frames = frames_of(path, 50.0);
    for (std::size_t k = 1; k < frames.size(); ++k) {
      const double step = glm::distance(frames[k].position, frames[k - 1].position);
      least = std::min(least, step);
      most = std::max(most, step);
    }
    return most / least;
  };
  EXPECT_LT(unevenness(KeyPath(set, 4.0)), 1.2);
  EXPECT_GT(unevenness(KeyPath(set)), 3.0);
  EXPECT_DOUBLE_EQ(KeyPath(set, 4.0).seconds(), 4.0);
  for (Camera& camera : set) camera.time.reset();
  EXPECT_DOUBLE_EQ(KeyPath(set, 4.0).seconds(), 4.0);
}

// An equal field of view in a larger window is no zoom.
TEST(KeyPath, KeepsSquarePixels) {
  Cameras set = {key({0, 0, 0}, 0, 150, 0), key({1, 0, 0}, 0, 150, 1), key({2, 0, 0}, 0, 75, 2)};
  const std::array<glm::ivec2, 3> sizes = {{{320, 180}, {180, 180}, {90, 90}}};
  for (std::size_t k = 0; k < set.size(); ++k) {
    set[k].width = sizes[k].x;
    set[k].height = sizes[k].y;
    set[k].cx = sizes[k].x / 2.0;
    set[k].cy = sizes[k].y / 2.0;
  }
  const KeyPath path(set);
  for (const double t : {0.0, 0.5, 1.0, 1.7, 2.0}) {
    const Camera camera = path.at(t);
    EXPECT_EQ(camera.width, 320);
    EXPECT_NEAR(camera.fx, 150.0, 1e-9) << t;
    EXPECT_NEAR(camera.fy, 150.0, 1e-9) << t;
    EXPECT_NEAR(camera.cx, 160.0, 1e-9) << t;
  }
}

TEST(KeyPath, FramesReachLastKey) {
  const Cameras frames = frames_of(KeyPath(keys()), 30.0);
  ASSERT_EQ(frames.size(), 226u);
  EXPECT_EQ(frames[0].name, "path_00000");
  EXPECT_EQ(frames[225].name, "path_00225");
  EXPECT_LT(glm::distance(frames[225].position, keys()[5].position), 1e-9);
  EXPECT_NEAR(*frames[30].time, 1.0, 1e-12);
  EXPECT_EQ(frames_of(KeyPath(keys()), 30.0, 0.5).size(), 15u);
}

TEST(KeyPath, DistinguishesKeysFromFrames) {
  const auto every = [](double apart, int count = 5, double first = 0.0) {
    Cameras set;
    for (int k = 0; k < count; ++k) set.push_back(key({k, 0, 0}, 0, 50, first + apart * k));
    return set;
  };
  EXPECT_TRUE(are_keys(every(1.0)));
  EXPECT_TRUE(are_keys(every(0.2)));
  EXPECT_FALSE(are_keys(every(1.0 / 12.0))) << "a film's";
  for (const int count : {5, 31, 50, 600}) {
    for (const double first : {0.0, 1.0, 1000.0})
      EXPECT_FALSE(are_keys(every(0.1, count, first))) << count << " at 10 a second, from " << first;
  }
  EXPECT_TRUE(are_keys(every(0.101, 50)));
  EXPECT_FALSE(are_keys(every(0.0))) << "as of files without times";
  EXPECT_FALSE(are_keys(every(1.0, 1)));
  Cameras none = every(1.0);
  none[2].time.reset();
  EXPECT_FALSE(are_keys(none));
}

TEST(KeyPath, RejectsInvalidPaths) {
  const Cameras set = keys();
  EXPECT_ERROR(frames_of(KeyPath(std::span<const Camera>(set).first(1)), 30.0),
               "at least two keys, found 1: add another");
  EXPECT_ERROR(KeyPath path(set, 0.0), "expected more than 0");
  Cameras back = set;
  std::swap(back[1].time, back[2].time);
  EXPECT_ERROR(KeyPath path(back), "give the path's duration in seconds");
  EXPECT_ERROR(frames_of(KeyPath(set), 1e9), "frames, more than");
}

}  // namespace
}  // namespace binosplat
