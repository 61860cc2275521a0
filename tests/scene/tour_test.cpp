#include "scene/tour.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/quaternion.hpp>

#include "support/errors.h"

namespace binosplat {
namespace {

using Cameras = std::vector<Camera>;

/// Returns a camera that looks along z, turned about y by `degrees`.
Camera camera_at(const glm::dvec3& place, double degrees = 0.0) {
  Camera camera{"c", 64, 48, 50.0, 50.0, 32.0, 24.0, place};
  camera.rotation = glm::mat3_cast(glm::angleAxis(glm::radians(degrees), glm::dvec3(0, 1, 0)));
  return camera;
}

/// Returns cameras on a circle that look inwards.
Cameras ring_of(int count, double radius) {
  Cameras out;
  for (int k = 0; k < count; ++k) {
    const double turn = glm::two_pi<double>() * k / count;
    out.push_back(
        camera_at({radius * std::sin(turn), 0.0, radius * std::cos(turn)}, 180.0 + glm::degrees(turn)));
  }
  return out;
}

/// Returns cameras about a metre apart in no order, with rotations of all sizes. Two at one position look in
/// opposite directions, and two look in the same one.
Cameras scattered() {
  Cameras out;
  for (int k = 0; k < 24; ++k) {
    const double a = std::fmod(7.13 * k, 5.0), b = std::fmod(3.77 * k * k, 4.0);
    out.push_back(camera_at({a, 0.1 * b, b}, std::fmod(131.0 * k, 360.0)));
  }
  out.push_back(camera_at(out[5].position, std::fmod(131.0 * 5 + 170.0, 360.0)));
  out.push_back(camera_at(out[9].position + glm::dvec3(0.4, 0, 0), std::fmod(131.0 * 9, 360.0)));
  return out;
}

/// Returns the angle between two rotations, in degrees.
double angle(const glm::dmat3& a, const glm::dmat3& b) {
  const glm::dquat p = glm::quat_cast(a), q = glm::quat_cast(b);
  return glm::degrees(4.0 * std::asin(0.5 * std::min(glm::length(p - q), glm::length(p + q))));
}

/// The head's velocities between two frames, relative to the motion's limits.
struct Step {
  glm::dvec3 going, turning;
  double fastest() const { return std::max(glm::length(going), glm::length(turning)); }
};

std::vector<Step> steps(const Cameras& frames, const TourSettings& settings) {
  std::vector<Step> out;
  for (std::size_t k = 1; k < frames.size(); ++k) {
    glm::dquat q = glm::quat_cast(frames[k].rotation * glm::transpose(frames[k - 1].rotation));
    if (q.w < 0.0) q = -q;
    const double share = settings.frames_per_second / glm::radians(settings.motion.degrees_per_second);
    out.push_back({(frames[k].position - frames[k - 1].position) * settings.frames_per_second /
                       (settings.units_per_metre * settings.motion.metres_per_second),
                   2.0 * share * glm::dvec3(q.x, q.y, q.z)});
  }
  return out;
}

double fastest(const Cameras& frames, const TourSettings& settings) {
  double out = 0.0;
  for (const Step& step : steps(frames, settings)) out = std::max(out, step.fastest());
  return out;
}

/// Returns the share of frames in which the speed or the rotation rate is within 10 % of its limit.
double at_full_speed(const Cameras& frames, const TourSettings& settings) {
  const std::vector<Step> all = steps(frames, settings);
  const auto full = std::ranges::count_if(all, [](const Step& step) { return step.fastest() > 0.9; });
  return static_cast<double>(full) / static_cast<double>(all.size());
}

/// Returns the largest change of velocity between frames; 1 is from rest to full speed in one frame.
double roughest(const Cameras& frames, const TourSettings& settings) {
  const std::vector<Step> all = steps(frames, settings);
  double out = 0.0;
  for (std::size_t k = 1; k < all.size(); ++k)
    out = std::max({out, glm::distance(all[k].going, all[k - 1].going),
                    glm::distance(all[k].turning, all[k - 1].turning)});
  return out;
}

/// The change per frame from rest to full speed in 0.15 s, plus 15 % for sampling.
constexpr double smooth = 1.15 / (0.15 * 90.0);

/// Returns the largest distance from a camera to its nearest frame: metres plus angle / 90 degrees.
double missed(const Cameras& cameras, const Cameras& frames, const TourSettings& settings) {
  double out = 0.0;
  for (const Camera& camera : cameras) {
    double least = INFINITY;
    for (const Camera& frame : frames)
      least = std::min(least, glm::distance(camera.position, frame.position) / settings.units_per_metre +
                                  angle(camera.rotation, frame.rotation) / 90.0);
    out = std::max(out, least);
  }
  return out;
}

/// Returns the length of the head's path in world units.
double length(const Cameras& frames) {
  double out = 0.0;
  for (std::size_t k = 1; k < frames.size(); ++k)
    out += glm::distance(frames[k].position, frames[k - 1].position);
  return out;
}

Cameras scaled(Cameras cameras, double factor) {
  for (Camera& camera : cameras) camera.position *= factor;
  return cameras;
}

const TourSettings walk{head_motions()[1]};

TEST(Tour, KeepsSpeedLimits) {
  for (const Motion& motion : head_motions()) {
    for (const double units : {1.0, 0.02, 30.0}) {
      for (const Cameras& cameras : {ring_of(12, 2.0), ring_of(40, 30.0), ring_of(5, 0.3), scattered()}) {
        const TourSettings settings{motion, 90.0, units};
        const Cameras frames = tour(scaled(cameras, units), settings);
        EXPECT_LT(fastest(frames, settings), 1.01) << motion.name;
        EXPECT_LT(roughest(frames, settings), smooth) << motion.name;
        // In a saccade, the head turns at full speed for a fifth of the time.
        EXPECT_GT(at_full_speed(frames, settings), 0.15) << motion.name;
      }
    }
  }
  const Cameras inwards = ring_of(24, 4.0);  // rotates 14.3 degrees per metre
  EXPECT_NEAR(*tour(inwards, {{"", 1.0, 90.0}}).back().time, 8.0 * glm::pi<double>() * 23 / 24, 0.3);
  EXPECT_NEAR(*tour(inwards, {{"", 1.0, 10.0}}).back().time, 1.8 * 345.0 / 10.0, 0.6) << "turns in saccades";
}

TEST(Tour, ComparisonDetectsJumps) {
  Cameras frames = tour(ring_of(12, 2.0), walk);  // injected: a shift of 5 mm to the side from one frame on
  for (std::size_t k = frames.size() / 2; k < frames.size(); ++k) frames[k].position.y += 0.005;
  EXPECT_GT(roughest(frames, walk), smooth);
}

TEST(Tour, FramesAreNamedAndTimed) {
  Cameras cameras = ring_of(12, 2.0);
  cameras[0].fx = 77.0;
  TourSettings settings = walk;
  settings.frames_per_second = 24.0;
  const Cameras frames = tour(cameras, settings);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    EXPECT_EQ(frames[k].name, fmt::format("tour_{:05}", k));
    EXPECT_DOUBLE_EQ(frames[k].time.value(), static_cast<double>(k) / 24.0);
    EXPECT_NEAR(frames[k].fx, 77.0, 1e-9);
    EXPECT_EQ(frames[k].width, 64);
  }
  EXPECT_LT(glm::distance(frames[0].position, cameras[0].position), 1e-9);
}

TEST(Tour, ShorterTourIsPrefix) {
  TourSettings settings{head_motions()[2]};
  const Cameras all = tour(scattered(), settings);
  for (const double seconds : {1e-3, 1.0, 2.0 / 3.0, 5.55, 1e3}) {
    settings.seconds = seconds;
    const Cameras some = tour(scattered(), settings);
    ASSERT_EQ(some.size(), std::min(all.size(), static_cast<std::size_t>(std::ceil(90.0 * seconds - 1e-6))));
    for (std::size_t k = 0; k < some.size(); ++k) EXPECT_EQ(some[k].position, all[k].position) << k;
  }
  settings.motion.metres_per_second = 1e-6;  // the whole tour would not fit into memory
  settings.seconds = 1.0;
  EXPECT_EQ(tour(scattered(), settings).size(), 90u);
}

TEST(Tour, PassesThroughEveryCamera) {
  for (const Motion& motion : head_motions()) {
    for (const Cameras& cameras : {ring_of(12, 2.0), scattered()}) {
      const TourSettings settings{motion};
      const Cameras frames = tour(cameras, settings);
      // The last frame may be almost one frame before the end.
      const double in_a_frame = (motion.metres_per_second + motion.degrees_per_second / 90.0) / 90.0;
      EXPECT_LT(missed(cameras, frames, settings), 1.01 * in_a_frame) << motion.name;
      Cameras other = cameras;  // injected: a camera that is not visited
      other[5].position.y += 4.0 * in_a_frame;
      EXPECT_GT(missed(other, frames, settings), 2.0 * in_a_frame) << motion.name;
    }
  }
}

TEST(Tour, TurnsInPlaceWithoutDetour) {
  // From the middle of a line to one end, then back through the middle to the other end.
  Cameras line;
  for (const double x : {0.0, 1.0, 2.0, 3.0, -1.5, -2.6, -3.7, -4.8, -5.9})
    line.push_back(camera_at({x, 0, 0}));
  EXPECT_NEAR(length(tour(line, walk)), 3.0 + 8.9, 0.05);
  const Cameras corner = {camera_at({0, 0, 0}), camera_at({2, 0, 0}), camera_at({2, 0, 0}, 120.0),
                          camera_at({2, 0, -2}, 120.0)};
  EXPECT_NEAR(length(tour(corner, walk)), 4.0, 0.02);
  const Cameras around = {camera_at({1, 1, 1}), camera_at({1, 1, 1}, 90.0), camera_at({1, 1, 1}, 180.0)};
  EXPECT_NEAR(*tour(around, walk).back().time, 1.8 * 180.0 / 82.0, 0.1);
  EXPECT_LT(length(tour(around, walk)), 1e-9);
}

TEST(Tour, DoesNotDependOnListOrder) {
  const Cameras two_equally_near = {camera_at({0, 0, 0}), camera_at({1, 0, 1}), camera_at({-1, 0, 1}),
                                    camera_at({1, 0, 2}), camera_at({-1, 0, 2})};
  for (const Cameras& cameras : {ring_of(15, 3.0), scattered(), two_equally_near}) {
    Cameras reversed = cameras;
    std::reverse(reversed.begin() + 1, reversed.end());
    const Cameras frames = tour(cameras, walk), again = tour(reversed, walk);
    ASSERT_EQ(frames.size(), again.size());
    for (std::size_t k = 0; k < frames.size(); ++k) {
      EXPECT_EQ(frames[k].position, again[k].position);
      EXPECT_EQ(frames[k].rotation, again[k].rotation);
    }
  }
}

TEST(Tour, IsShort) {
  // Always going to the nearest camera would go back and forth: 19.5 m.
  Cameras line;
  for (const double x : {0.0, 1.0, -1.5, 4.0, -6.5}) line.push_back(camera_at({x, 0, 0}));
  EXPECT_NEAR(length(tour(line, walk)), 14.5, 0.1);
  Cameras grid;
  for (int k = 0; k < 64; ++k) grid.push_back(camera_at({k * 27 % 64 / 8, 0, k * 27 % 8}));
  EXPECT_LT(length(tour(grid, walk)), 1.2 * 63.0);
  EXPECT_GT(length(grid), 2.0 * 63.0);
}

TEST(Tour, DuplicatesAreOneStop) {
  Cameras twice = ring_of(12, 2.0);
  for (const Camera& camera : ring_of(12, 2.0)) twice.push_back(camera);
  for (Camera& camera : twice) camera.position += 1e-4 * glm::dvec3(camera.position.z, 0, 0);
  EXPECT_NEAR(length(tour(twice, walk)), length(tour(ring_of(12, 2.0), walk)), 0.01);
}

/// Returns each camera as the two eyes of a head, 0.063 apart.
Cameras as_pairs(const Cameras& cameras) {
  Cameras out;
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    for (const int side : {-1, 1}) {
      Camera& eye = out.emplace_back(cameras[k]);
      eye.name = fmt::format("pair{}_{}", k, side < 0 ? "left" : "right");
      eye.position += 0.0315 * side * eye.rotation[0];
      eye.cx -= 3.0 * side;
    }
  }
  return out;
}

TEST(Tour, EyePairIsOneHead) {
  const Cameras heads = ring_of(12, 2.0);
  const Cameras of_heads = tour(heads, walk);
  Cameras pairs = as_pairs(heads);
  for (int turn = 0; turn < 2; ++turn) {  // the right eye may come first
    const Cameras of_pairs = tour(pairs, walk);
    ASSERT_EQ(of_pairs.size(), of_heads.size());
    EXPECT_LT(glm::distance(of_pairs[9].position, of_heads[9].position), 1e-9);
    EXPECT_LT(angle(of_pairs[9].rotation, of_heads[9].rotation), 1e-6);
    EXPECT_EQ(of_pairs[9].cx, of_heads[9].cx);
    EXPECT_NEAR(estimated_metre(pairs), estimated_metre(heads), 1e-9);
    const Cameras merged = heads_from_pairs(pairs);
    ASSERT_EQ(merged.size(), heads.size());
    for (std::size_t k = 0; k < heads.size(); ++k)
      EXPECT_LT(glm::distance(merged[k].position, heads[k].position), 1e-9) << k;
    for (std::size_t k = 0; k < pairs.size(); k += 2) std::swap(pairs[k], pairs[k + 1]);
  }
  for (Camera& camera : pairs) camera.name += "_eye";  // injected: the names do not identify pairs
  EXPECT_NEAR(estimated_metre(pairs), 0.063, 1e-9);
  EXPECT_NE(tour(pairs, walk).size(), of_heads.size());
}

TEST(Tour, MetreIsMedianCameraDistance) {
  Cameras cameras = ring_of(6, 3.0);  // 3 apart
  EXPECT_NEAR(estimated_metre(cameras), 3.0, 1e-9);
  cameras.push_back(camera_at({500, 0, 0}));                                            // one outlier
  for (int k = 0; k < 6; ++k) cameras.push_back(cameras[static_cast<std::size_t>(k)]);  // and duplicates
  EXPECT_NEAR(estimated_metre(cameras), 3.0, 1e-9);
  EXPECT_NEAR(estimated_metre(scaled(cameras, 0.01)), 0.03, 1e-9);
  EXPECT_EQ(estimated_metre({}), 1.0);
  EXPECT_EQ(estimated_metre(Cameras{camera_at({1, 2, 3})}), 1.0);
  EXPECT_EQ(estimated_metre(Cameras{camera_at({1, 2, 3}), camera_at({1, 2, 3}, 90.0)}), 1.0);
}

TEST(Tour, RejectsInvalidTours) {
  const auto refused = [](const Cameras& cameras, const TourSettings& settings,
                          std::initializer_list<std::string> parts) {
    return test::fails_saying([&] { tour(cameras, settings); }, parts);
  };
  const Cameras cameras = ring_of(3, 1.0);
  EXPECT_TRUE(refused({}, walk, {"at least two cameras, found 0"}));
  EXPECT_TRUE(refused(as_pairs({cameras[0]}), walk, {"at least two cameras, found 1"}));
  EXPECT_TRUE(refused({cameras[0], cameras[0]}, walk, {"different poses", "1 world units per metre"}));
  EXPECT_TRUE(refused(cameras, {{"snail", 1e-6, 45.0}}, {"frames, more than", "a faster tour"}));
  EXPECT_TRUE(refused(cameras, {{"snail", 1e-12, 45.0}}, {"choose a faster one"}));
  EXPECT_EQ(tour(cameras, {{"light", 1e300, 1e300}}).size(), 1u);
}

}  // namespace
}  // namespace binosplat
