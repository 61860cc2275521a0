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

/// A camera that is turned about y from looking along z, in degrees.
Camera camera_at(const glm::dvec3& place, double degrees = 0.0) {
  Camera camera{"c", 64, 48, 50.0, 50.0, 32.0, 24.0, place};
  camera.rotation = glm::mat3_cast(glm::angleAxis(glm::radians(degrees), glm::dvec3(0, 1, 0)));
  return camera;
}

/// Cameras on a circle that look inwards.
Cameras ring_of(int count, double radius, double height = 0.0) {
  Cameras out;
  for (int k = 0; k < count; ++k) {
    const double turn = glm::two_pi<double>() * k / count;
    out.push_back(
        camera_at({radius * std::sin(turn), height, radius * std::cos(turn)}, 180.0 + glm::degrees(turn)));
  }
  return out;
}

/// Places a metre or so apart in no order, with turns of all sizes; two cameras at one place that look to
/// opposite sides, and two that look the same way.
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

/// Degrees between two rotations.
double angle(const glm::dmat3& a, const glm::dmat3& b) {
  const glm::dquat p = glm::quat_cast(a), q = glm::quat_cast(b);
  return glm::degrees(4.0 * std::asin(0.5 * std::min(glm::length(p - q), glm::length(p + q))));
}

/// What a frame does, from the last: in metres and degrees a second.
struct Step {
  glm::dvec3 going, turning;
};

std::vector<Step> steps(const Cameras& frames, const TourSettings& settings) {
  std::vector<Step> out;
  for (std::size_t k = 1; k < frames.size(); ++k) {
    const glm::dmat3 turn = frames[k].rotation * glm::transpose(frames[k - 1].rotation);
    glm::dquat q = glm::quat_cast(turn);
    if (q.w < 0.0) q = -q;
    const double degrees = angle(frames[k].rotation, frames[k - 1].rotation),
                 sine = std::hypot(q.x, q.y, q.z);
    const glm::dvec3 axis = sine > 0.0 ? glm::dvec3(q.x, q.y, q.z) / sine : glm::dvec3(0.0);
    out.push_back({(frames[k].position - frames[k - 1].position) * settings.frames_per_second /
                       settings.units_per_metre,
                   axis * degrees * settings.frames_per_second});
  }
  return out;
}

/// The largest share of what is allowed that a frame takes.
double fastest(const Cameras& frames, const TourSettings& settings) {
  double out = 0.0;
  for (const Step& step : steps(frames, settings))
    out = std::max({out, glm::length(step.going) / settings.motion.metres_per_second,
                    glm::length(step.turning) / settings.motion.degrees_per_second});
  return out;
}

/// The share of frames in which the head goes or turns as fast as allowed, to 2 %.
double at_full_speed(const Cameras& frames, const TourSettings& settings) {
  const std::vector<Step> all = steps(frames, settings);
  const auto full = [&](const Step& step) {
    return glm::length(step.going) > 0.98 * settings.motion.metres_per_second ||
           glm::length(step.turning) > 0.98 * settings.motion.degrees_per_second;
  };
  return static_cast<double>(std::count_if(all.begin(), all.end(), full)) / static_cast<double>(all.size());
}

/// The largest change of velocity from frame to frame as a share of what is allowed: 1 is from rest to full
/// speed in one frame, 2 is back and forth.
double roughest(const Cameras& frames, const TourSettings& settings) {
  const std::vector<Step> all = steps(frames, settings);
  double out = 0.0;
  for (std::size_t k = 1; k < all.size(); ++k)
    out = std::max({out, glm::distance(all[k].going, all[k - 1].going) / settings.motion.metres_per_second,
                    glm::distance(all[k].turning, all[k - 1].turning) / settings.motion.degrees_per_second});
  return out;
}

/// The largest distance, in metres and in parts of 90 degrees, from a camera to the frame that is nearest.
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

/// How far the head goes in metres.
double length(const Cameras& frames, const TourSettings& settings) {
  double out = 0.0;
  for (const Step& step : steps(frames, settings))
    out += glm::length(step.going) / settings.frames_per_second;
  return out;
}

TourSettings settings_for(const std::string& name, double units = 1.0) {
  for (const Motion& motion : head_motions())
    if (motion.name == name) return {motion, 90.0, units};
  ADD_FAILURE() << "no motion " << name;
  return {};
}

Cameras scaled(Cameras cameras, double factor) {
  for (Camera& camera : cameras) camera.position *= factor;
  return cameras;
}

TEST(Tour, GoesAsFastAsAllowedAndNoFaster) {
  for (const char* name : {"calm", "walk", "fast"}) {
    for (const double units : {1.0, 0.02, 30.0}) {
      for (const Cameras& cameras : {ring_of(12, 2.0), ring_of(40, 30.0), scattered()}) {
        const TourSettings settings = settings_for(name, units);
        const Cameras frames = tour(scaled(cameras, units), settings);
        EXPECT_LT(fastest(frames, settings), 1.0 + 1e-6) << name;
        // At 6 m/s a quarter of a second of speeding up is 0.75 m of these small rooms.
        EXPECT_GT(at_full_speed(frames, settings), settings.motion.metres_per_second > 2.0 ? 0.4 : 0.7)
            << name;
        TourSettings slower = settings;  // a head that goes too fast or too slowly would show
        slower.motion.metres_per_second *= 0.97;
        slower.motion.degrees_per_second *= 0.97;
        EXPECT_GT(fastest(frames, slower), 1.01);
        const Cameras late = tour(scaled(cameras, units), slower);
        EXPECT_LT(at_full_speed(late, settings), 0.01);
      }
    }
  }
}

TEST(Tour, TheSlowerLimitBinds) {
  const Cameras inwards = ring_of(24, 4.0);  // turns 14.3 degrees a metre
  TourSettings settings{{"", 1.0, 90.0}, 90.0, 1.0};
  const double by_way = tour(inwards, settings).back().time.value();
  EXPECT_NEAR(by_way, 8.0 * glm::pi<double>() * 23 / 24, 0.3);
  settings.motion.degrees_per_second = 10.0;
  const double by_turn = tour(inwards, settings).back().time.value();
  EXPECT_NEAR(by_turn, 345.0 / 10.0, 0.3);
}

TEST(Tour, FramesAreNamedAndTimed) {
  Cameras cameras = ring_of(12, 2.0);
  cameras[0].name = "first";
  cameras[0].fx = 77.0;
  TourSettings settings = settings_for("walk");
  settings.frames_per_second = 24.0;
  const Cameras frames = tour(cameras, settings);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    EXPECT_EQ(frames[k].name, fmt::format("tour_{:05}", k));
    EXPECT_DOUBLE_EQ(frames[k].time.value(), static_cast<double>(k) / 24.0);
    EXPECT_EQ(frames[k].fx, 77.0);
    EXPECT_EQ(frames[k].width, 64);
  }
  EXPECT_LT(glm::distance(frames[0].position, cameras[0].position), 1e-9);
}

TEST(Tour, FewerSecondsAreTheFirstOnes) {
  TourSettings settings = settings_for("fast");
  const Cameras all = tour(scattered(), settings);
  for (const double seconds : {1e-3, 1.0, 2.0 / 3.0, 5.55, 1e3}) {
    settings.seconds = seconds;
    const Cameras some = tour(scattered(), settings);
    ASSERT_EQ(some.size(), std::min(all.size(), static_cast<std::size_t>(std::ceil(90.0 * seconds - 1e-6))));
    for (std::size_t k = 0; k < some.size(); ++k) EXPECT_EQ(some[k].position, all[k].position) << k;
  }
  settings.motion.metres_per_second = 1e-9;  // all of it would not fit
  settings.seconds = 1.0;
  EXPECT_EQ(tour(scattered(), settings).size(), 90u);
}

TEST(Tour, PassesThroughEveryCamera) {
  for (const char* name : {"calm", "walk", "fast"}) {
    for (const Cameras& cameras : {ring_of(12, 2.0), scattered()}) {
      const TourSettings settings = settings_for(name);
      const Cameras frames = tour(cameras, settings);
      // The last frame may be almost one before the end.
      const double in_a_frame =
          (settings.motion.metres_per_second + settings.motion.degrees_per_second / 90.0) / 90.0;
      EXPECT_LT(missed(cameras, frames, settings), 1.01 * in_a_frame) << name;
      Cameras other = cameras;  // a camera that is left out would show
      other[5].position.y += 4.0 * in_a_frame;
      EXPECT_GT(missed(other, frames, settings), 2.0 * in_a_frame) << name;
    }
  }
}

// The largest change in a frame: by 1 in 0.25 s along the way and as much across it; sharp bends are sampled
// as corners.
constexpr double smooth = 2.0 / (0.25 * 90.0);

TEST(Tour, IsSmooth) {
  for (const char* name : {"calm", "walk", "fast"}) {
    for (const Cameras& cameras : {ring_of(12, 2.0), ring_of(5, 0.3), scattered()}) {
      const TourSettings settings = settings_for(name);
      EXPECT_LT(roughest(tour(cameras, settings), settings), smooth) << name;
    }
  }
}

TEST(Tour, WhatIsNotSmoothIsNoticed) {
  const TourSettings settings = settings_for("walk");
  const Cameras good = tour(ring_of(12, 2.0), settings);
  const double was = roughest(good, settings);
  Cameras jump = good;  // 5 mm to the side from one frame on
  for (std::size_t k = good.size() / 2; k < good.size(); ++k) jump[k].position.y += 0.005;
  EXPECT_GT(roughest(jump, settings), std::max(smooth, 2.0 * was));
  Cameras twitch = good;  // half a degree in one frame
  twitch[20].rotation = twitch[20].rotation * glm::mat3_cast(glm::angleAxis(0.01, glm::dvec3(1, 0, 0)));
  EXPECT_GT(roughest(twitch, settings), std::max(smooth, 2.0 * was));
  // Straight ways from camera to camera: each bend is 30 degrees.
  Cameras polygon;
  const Cameras stops = ring_of(12, 2.0);
  for (std::size_t k = 1; k < stops.size(); ++k)
    for (int n = 0; n < 62; ++n) {
      polygon.push_back(stops[k]);
      polygon.back().position = glm::mix(stops[k - 1].position, stops[k].position, n / 62.0);
    }
  EXPECT_GT(roughest(polygon, settings), smooth);
}

TEST(Tour, SlowsDownWhereItTurnsBack) {
  // From the middle of a line to one end, and back through the middle to the other.
  Cameras line;
  for (const double x : {0.0, 1.0, 2.0, 3.0, -1.5, -2.6, -3.7, -4.8, -5.9})
    line.push_back(camera_at({x, 0, 0}));
  const TourSettings settings = settings_for("walk");
  const Cameras frames = tour(line, settings);
  EXPECT_LT(missed(line, frames, settings), 0.01);
  EXPECT_NEAR(length(frames, settings), 3.0 + 8.9, 0.05);
  EXPECT_LT(roughest(frames, settings), smooth);
  EXPECT_GT(at_full_speed(frames, settings), 0.8);
}

TEST(Tour, TurnsOnTheSpot) {
  Cameras cameras = {camera_at({0, 0, 0}), camera_at({2, 0, 0}), camera_at({2, 0, 0}, 120.0),
                     camera_at({2, 0, -2}, 120.0)};
  const TourSettings settings = settings_for("walk");
  const Cameras frames = tour(cameras, settings);
  EXPECT_LT(missed(cameras, frames, settings), 0.02);
  EXPECT_NEAR(length(frames, settings), 4.0, 0.01) << "no detour while it turns";
  EXPECT_LT(roughest(frames, settings), smooth);
  Cameras around = {camera_at({1, 1, 1}), camera_at({1, 1, 1}, 90.0), camera_at({1, 1, 1}, 180.0)};
  const Cameras turned = tour(around, settings);
  EXPECT_NEAR(turned.back().time.value(), 4.0, 0.02);
  EXPECT_LT(length(turned, settings), 1e-9);
}

/// Which cameras follow one another, by the order in which the frames pass them; as their numbers in
/// `places`.
std::vector<std::size_t> order(const Cameras& places, const Cameras& frames) {
  std::vector<std::pair<std::size_t, std::size_t>> passed;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto nearest =
        std::min_element(frames.begin(), frames.end(), [&](const Camera& a, const Camera& b) {
          return glm::distance(a.position, places[i].position) <
                 glm::distance(b.position, places[i].position);
        });
    passed.emplace_back(nearest - frames.begin(), i);
  }
  std::sort(passed.begin(), passed.end());
  std::vector<std::size_t> out;
  for (const auto& [frame, i] : passed) out.push_back(i);
  return out;
}

TEST(Tour, TheListsOrderDoesNotCount) {
  const Cameras cameras = ring_of(15, 3.0);
  const TourSettings settings = settings_for("walk");
  const Cameras frames = tour(cameras, settings);
  Cameras shuffled = cameras;
  for (std::size_t k = 1; k < 15; ++k) shuffled[k] = cameras[1 + (5 * k + 3) % 14];
  const Cameras again = tour(shuffled, settings);
  ASSERT_EQ(frames.size(), again.size());
  for (std::size_t k = 0; k < frames.size(); ++k) {
    EXPECT_EQ(frames[k].position, again[k].position);
    EXPECT_EQ(frames[k].rotation, again[k].rotation);
  }
  const std::vector<std::size_t> found = order(cameras, frames);
  for (std::size_t k = 1; k < found.size(); ++k) {
    const std::size_t apart = (found[k] + 15 - found[k - 1]) % 15;
    EXPECT_TRUE(apart == 1 || apart == 14) << found[k - 1] << " and " << found[k] << " are no neighbours";
  }
}

TEST(Tour, TheListsOrderDoesNotCountWhereTwoAreEquallyNear) {
  const Cameras cameras = {camera_at({0, 0, 0}), camera_at({1, 0, 1}), camera_at({-1, 0, 1}),
                           camera_at({1, 0, 2}), camera_at({-1, 0, 2})};
  Cameras reversed = cameras;
  std::reverse(reversed.begin() + 1, reversed.end());
  const TourSettings settings = settings_for("walk");
  EXPECT_EQ(tour(cameras, settings).back().position, tour(reversed, settings).back().position);
}

TEST(Tour, LooksFartherThanTheNextCamera) {
  // Who always goes to the nearest goes to and fro, 19.5 m.
  Cameras line;
  for (const double x : {0.0, 1.0, -1.5, 4.0, -6.5}) line.push_back(camera_at({x, 0, 0}));
  const TourSettings settings = settings_for("walk");
  EXPECT_NEAR(length(tour(line, settings), settings), 14.5, 0.1);
}

TEST(Tour, IsMuchShorterThanTheListsOrder) {
  const TourSettings settings = settings_for("walk");
  Cameras grid;
  for (int k = 0; k < 64; ++k) grid.push_back(camera_at({k * 27 % 64 / 8, 0, k * 27 % 8}));
  double as_listed = 0.0;
  for (std::size_t k = 1; k < grid.size(); ++k)
    as_listed += glm::distance(grid[k].position, grid[k - 1].position);
  const double found = length(tour(grid, settings), settings);
  EXPECT_LT(found, 1.2 * 63.0);
  EXPECT_GT(as_listed, 2.0 * 63.0);
}

TEST(Tour, NeverTurnsTheLongWayRound) {
  // Quaternions change sign between 170 and 190 degrees; the camera turns by 20.
  const TourSettings settings = settings_for("walk");
  Cameras cameras;
  for (int k = 0; k < 40; ++k) cameras.push_back(camera_at({0.5 * k, 0, 0}, 20.0 * k));
  const Cameras frames = tour(cameras, settings);
  double turned = 0.0;
  for (const Step& step : steps(frames, settings))
    turned += glm::length(step.turning) / settings.frames_per_second;
  EXPECT_NEAR(turned, 39 * 20.0, 1.0);
  EXPECT_LT(missed(cameras, frames, settings), 0.02);
}

TEST(Tour, DuplicatesAreOneStop) {
  Cameras twice = ring_of(12, 2.0);
  for (const Camera& camera : ring_of(12, 2.0)) twice.push_back(camera);
  for (Camera& camera : twice) camera.position += 1e-4 * glm::dvec3(camera.position.z, 0, 0);
  const TourSettings settings = settings_for("walk");
  EXPECT_NEAR(length(tour(twice, settings), settings), length(tour(ring_of(12, 2.0), settings), settings),
              0.01);
}

/// Each camera as the eyes of a head, 0.063 apart.
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

TEST(Tour, TheEyesOfAPairAreOneHead) {
  const TourSettings settings = settings_for("walk");
  const Cameras heads = ring_of(12, 2.0);
  const Cameras of_heads = tour(heads, settings);
  Cameras pairs = as_pairs(heads);
  for (int turn = 0; turn < 2; ++turn) {  // the right eye may come first
    const Cameras of_pairs = tour(pairs, settings);
    ASSERT_EQ(of_pairs.size(), of_heads.size());
    EXPECT_LT(glm::distance(of_pairs[9].position, of_heads[9].position), 1e-9);
    EXPECT_LT(angle(of_pairs[9].rotation, of_heads[9].rotation), 1e-6);
    EXPECT_EQ(of_pairs[9].cx, of_heads[9].cx);
    EXPECT_NEAR(metre_of(pairs), metre_of(heads), 1e-9);
    const Cameras merged = heads_of(pairs);
    ASSERT_EQ(merged.size(), heads.size());
    for (std::size_t k = 0; k < heads.size(); ++k)
      EXPECT_LT(glm::distance(merged[k].position, heads[k].position), 1e-9) << k;
    for (std::size_t k = 0; k < pairs.size(); k += 2) std::swap(pairs[k], pairs[k + 1]);
  }
  for (Camera& camera : pairs) camera.name += "_eye";  // nothing says that they are pairs
  EXPECT_NEAR(metre_of(pairs), 0.063, 1e-9);
  EXPECT_NE(tour(pairs, settings).size(), of_heads.size());
}

TEST(Tour, MetreIsTheUsualWayToTheNextCamera) {
  Cameras cameras = ring_of(6, 3.0);  // 3 apart
  EXPECT_NEAR(metre_of(cameras), 3.0, 1e-9);
  cameras.push_back(camera_at({500, 0, 0}));                                            // one outlier
  for (int k = 0; k < 6; ++k) cameras.push_back(cameras[static_cast<std::size_t>(k)]);  // and duplicates
  EXPECT_NEAR(metre_of(cameras), 3.0, 1e-9);
  EXPECT_NEAR(metre_of(scaled(cameras, 0.01)), 0.03, 1e-9);
  EXPECT_EQ(metre_of({}), 1.0);
  EXPECT_EQ(metre_of(Cameras{camera_at({1, 2, 3})}), 1.0);
  EXPECT_EQ(metre_of(Cameras{camera_at({1, 2, 3}), camera_at({1, 2, 3}, 90.0)}), 1.0);
}

TEST(Tour, ErrorsSayWhatIsMissing) {
  const TourSettings walk = settings_for("walk");
  const auto refused = [](const Cameras& cameras, const TourSettings& settings,
                          std::initializer_list<std::string> parts) {
    return test::fails_saying([&] { tour(cameras, settings); }, parts);
  };
  const Cameras cameras = ring_of(3, 1.0);
  EXPECT_TRUE(refused({}, walk, {"two cameras or more, and there is 0", "--cameras", "--orbit"}));
  EXPECT_TRUE(refused({cameras[0]}, walk, {"two cameras or more, and there is 1"}));
  EXPECT_TRUE(refused(as_pairs({cameras[0]}), walk, {"two cameras or more, and there is 1"}));
  EXPECT_TRUE(refused({cameras[0], cameras[0]}, walk, {"that lie apart", "1 world units a metre"}));
  for (const double wrong : {0.0, -1.0, std::nan(""), double{INFINITY}}) {
    TourSettings settings = walk;
    settings.motion.metres_per_second = wrong;
    EXPECT_TRUE(refused(cameras, settings, {"speeds above 0"}));
    settings = walk;
    settings.motion.degrees_per_second = wrong;
    EXPECT_TRUE(refused(cameras, settings, {"speeds above 0"}));
    settings = walk;
    settings.frames_per_second = wrong;
    EXPECT_TRUE(refused(cameras, settings, {"frames a second"}));
    settings = walk;
    settings.units_per_metre = wrong;
    EXPECT_TRUE(refused(cameras, settings, {"units a metre"}));
  }
  TourSettings none = walk;
  none.seconds = 0.0;
  EXPECT_TRUE(refused(cameras, none, {"0 seconds"}));
  TourSettings snail = walk;
  snail.motion.metres_per_second = 1e-9;
  EXPECT_TRUE(refused(cameras, snail, {"go faster"}));
}

}  // namespace
}  // namespace binosplat
