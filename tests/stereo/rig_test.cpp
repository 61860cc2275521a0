#include "stereo/rig.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <random>

#include "base/error.h"
#include "formats/cameras/cameras_file.h"

namespace binosplat::stereo {
namespace {

template <typename T>
bool same_words(const T& a, const T& b) {
  using Words = std::array<std::uint32_t, sizeof(T) / 4>;
  return std::bit_cast<Words>(a) == std::bit_cast<Words>(b);
}

bool share_z(const EyePair& pair) { return same_words(pair.views[0].row_z, pair.views[1].row_z); }

Camera head_camera() {
  Camera head = look_at({1.5, -0.4, -3.0}, {0.2, 0.1, 1.0}, {0.1, -1.0, 0.05}, 60.0, 1280, 720);
  head.name = "head";
  return head;
}

/// Returns a world point in the eye's space of a View, computed in fp32 like a shader.
glm::dvec3 to_eye(const shared::View& view, const glm::vec3& p) {
  const glm::vec3 d = p - glm::vec3(view.anchor);
  const auto row = [&](const glm::vec4& r) { return r.x * d.x + r.y * d.y + r.z * d.z + r.w; };
  return {row(view.row_x), row(view.row_y), row(view.row_z)};
}

glm::dvec2 pixel(const shared::View& view, const glm::vec3& p) {
  const glm::dvec3 v = to_eye(view, p);
  return {view.lens.x * v.x / v.z + view.lens.z - 0.5, view.lens.y * v.y / v.z + view.lens.w - 0.5};
}

/// Returns the world point at (x, y, z) in the head's axes.
glm::vec3 seen_at(const Camera& head, const glm::dvec3& v) {
  return glm::vec3(head.position + head.rotation * v);
}

/// The check of most tests here. Some points of known depth must have the disparity of docs/method.md 6 and
/// no vertical parallax. The middle between their two pixels must be where the head sees the point.
bool disparity_is_right(const EyePair& pair, const Camera& head, double ipd, double convergence) {
  for (const glm::dvec3& v :
       {glm::dvec3(0, 0, 1), glm::dvec3(0.3, -0.2, 0.6), glm::dvec3(-2, 1, 5), glm::dvec3(3, 1, 80)}) {
    const glm::vec3 p = seen_at(head, v);
    const glm::dvec2 left = pixel(pair.views[0], p), right = pixel(pair.views[1], p);
    const double expected = head.fx * ipd * (1.0 / v.z - 1.0 / convergence);
    const glm::dvec2 middle(head.fx * v.x / v.z + head.cx - 0.5, head.fy * v.y / v.z + head.cy - 0.5);
    if (std::abs(left.x - right.x - expected) > 2e-3 || std::abs(left.y - right.y) > 1e-6 ||
        glm::length(0.5 * (left + right) - middle) > 2e-3) {
      return false;
    }
  }
  return true;
}

constexpr double infinitely_far = std::numeric_limits<double>::infinity();

TEST(Rig, KnownPointHasKnownDisparity) {
  const Camera head = head_camera();
  const EyePair pair = make_rig(head, {});
  EXPECT_TRUE(disparity_is_right(pair, head, 0.063, infinitely_far));
  EXPECT_EQ(pair.cameras[0].name, "head_left");
  EXPECT_EQ(pair.cameras[1].name, "head_right");
  // By hand: at 1 m with 63 mm between the eyes, the disparity is fx * 0.063 px. The left eye sees the point
  // further right.
  const glm::vec3 p = seen_at(head, {0, 0, 1});
  EXPECT_NEAR(pixel(pair.views[0], p).x - pixel(pair.views[1], p).x,
              0.063 * 360.0 / std::tan(glm::radians(30.0)), 1e-3);

  EyePair fault = pair;
  std::swap(fault.views[0], fault.views[1]);
  EXPECT_FALSE(disparity_is_right(fault, head, 0.063, infinitely_far)) << "swapped eyes go unnoticed";
  fault = pair;
  fault.views[1] = fault.views[0];
  EXPECT_FALSE(disparity_is_right(fault, head, 0.063, infinitely_far)) << "one eye twice goes unnoticed";
}

TEST(Rig, MetresBecomeWorldUnits) {
  const Camera head = head_camera();
  RigSettings settings;
  settings.ipd = 0.05;
  settings.units_per_metre = 3.0;
  settings.convergence = 2.0;
  const EyePair pair = make_rig(head, settings);
  EXPECT_TRUE(disparity_is_right(pair, head, 0.15, 6.0));
  EXPECT_FALSE(disparity_is_right(pair, head, 0.05, 2.0)) << "metres taken for world units go unnoticed";
  EXPECT_NEAR(glm::length(pair.cameras[1].position - pair.cameras[0].position), 0.15, 1e-12);
}

TEST(Rig, ConvergenceShiftsFrustum) {
  const Camera head = head_camera();
  RigSettings settings;
  settings.convergence = 1.5;
  const EyePair pair = make_rig(head, settings);
  EXPECT_TRUE(same_words(pair.views[0].row_z, pair.views[1].row_z));
  EXPECT_TRUE(disparity_is_right(pair, head, 0.063, 1.5));
  const glm::vec3 p = seen_at(head, {0.4, 0.3, 1.5});
  EXPECT_NEAR(pixel(pair.views[0], p).x, pixel(pair.views[1], p).x, 1e-3)
      << "no disparity in the convergence plane";

  EyePair fault = pair;
  std::swap(fault.views[0].lens.z, fault.views[1].lens.z);
  EXPECT_FALSE(disparity_is_right(fault, head, 0.063, 1.5)) << "a shift of the wrong sign goes unnoticed";
  EXPECT_FALSE(disparity_is_right(make_rig(head, {}), head, 0.063, 1.5)) << "no shift goes unnoticed";

  // Injected: eyes that turn towards the plane instead have vertical parallax away from the middle.
  settings.convergence.reset();
  settings.cant_degrees = -glm::degrees(std::atan(0.0315 / 1.5));
  const EyePair toed_in = make_rig(head, settings);
  const glm::vec3 corner = seen_at(head, {0.9, 0.6, 1.5});
  EXPECT_GT(std::abs(pixel(toed_in.views[0], corner).y - pixel(toed_in.views[1], corner).y), 1.0);
}

TEST(Rig, HeadRollTurnsBaseline) {
  Camera head = head_camera();
  // A quarter turn of the head, clockwise for its wearer: the x axis goes where the y axis (down) was.
  head.rotation = glm::dmat3(head.rotation[1], -head.rotation[0], head.rotation[2]);
  const EyePair pair = make_rig(head, {});
  EXPECT_TRUE(disparity_is_right(pair, head, 0.063, infinitely_far));
  EXPECT_NEAR(glm::dot(pair.cameras[1].position - pair.cameras[0].position, head_camera().rotation[1]), 0.063,
              1e-12)
      << "the right eye is below the left one";

  // Injected: the pictures roll with the head, but the baseline does not.
  EyePair fault = make_rig(head_camera(), {});
  for (std::size_t k = 0; k < 2; ++k) {
    Camera eye = fault.cameras[k];
    eye.rotation = head.rotation;
    fault.views[k] = make_view(eye, glm::vec3(head.position), near_default);
  }
  EXPECT_FALSE(disparity_is_right(fault, head, 0.063, infinitely_far))
      << "a baseline that does not roll goes unnoticed";
}

glm::dmat3 random_rotation(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
  const double n = w * w + x * x + y * y + z * z;
  return glm::dmat3(1.0 - 2.0 * (y * y + z * z) / n, 2.0 * (x * y + w * z) / n, 2.0 * (x * z - w * y) / n,
                    2.0 * (x * y - w * z) / n, 1.0 - 2.0 * (x * x + z * z) / n, 2.0 * (y * z + w * x) / n,
                    2.0 * (x * z + w * y) / n, 2.0 * (y * z - w * x) / n, 1.0 - 2.0 * (x * x + y * y) / n);
}

/// Returns random heads, near the origin and up to 1e5 world units from it.
std::vector<Camera> random_heads(int count) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<Camera> heads;
  for (int i = 0; i < count; ++i) {
    Camera head = head_camera();
    head.rotation = random_rotation(random);
    const double reach = std::pow(10.0, i % 6);
    for (int k = 0; k < 3; ++k) head.position[k] = reach * unit(random);
    heads.push_back(head);
  }
  return heads;
}

TEST(Rig, ParallelEyesShareThirdRow) {
  int differ_when_not_shared = 0;
  for (const Camera& head : random_heads(600)) {
    RigSettings settings;
    settings.convergence = 2.0;
    const EyePair pair = make_rig(head, settings);
    ASSERT_TRUE(same_words(pair.views[0].row_z, pair.views[1].row_z));
    ASSERT_TRUE(same_words(pair.views[0].row_y, pair.views[1].row_y));
    ASSERT_TRUE(same_words(pair.views[0].anchor, pair.views[1].anchor));
    // The reason for the sharing: computed from each eye's position, z sometimes differs.
    const glm::vec3 anchor(head.position);
    differ_when_not_shared += !same_words(make_view(pair.cameras[0], anchor, near_default).row_z,
                                          make_view(pair.cameras[1], anchor, near_default).row_z);
  }
  EXPECT_GT(differ_when_not_shared, 0) << "this test would not notice rows computed eye by eye";
}

TEST(Rig, ZeroEyeDistanceGivesEqualViews) {
  RigSettings settings;
  settings.ipd = 0.0;
  settings.convergence = 1.0;
  std::vector<Camera> heads = random_heads(60);
  heads.push_back(
      Camera{.name = "origin", .width = 64, .height = 48, .fx = 50, .fy = 50, .cx = 32, .cy = 24});
  for (const Camera& head : heads) {
    const EyePair pair = make_rig(head, settings);
    ASSERT_TRUE(same_words(pair.views[0], pair.views[1]));
  }
  settings.ipd = 1e-6;
  const EyePair apart = make_rig(head_camera(), settings);
  EXPECT_FALSE(same_words(apart.views[0], apart.views[1]));
}

/// Returns the largest error of fp32 positions in the eye's space, relative to their distance from the eye,
/// for points around a head.
double worst_error(const shared::View& view, const Camera& eye) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  double worst = 0.0;
  for (int i = 0; i < 200; ++i) {
    glm::dvec3 v;
    for (int k = 0; k < 3; ++k) v[k] = 10.0 * unit(random);
    const glm::vec3 p(eye.position + v);  // rounded: a model's positions are floats too
    const glm::dvec3 exact = glm::transpose(eye.rotation) * (glm::dvec3(p) - eye.position);
    worst = std::max(worst, glm::length(to_eye(view, p) - exact) / glm::length(exact));
  }
  return worst;
}

TEST(Rig, KeepsPrecisionFarFromOrigin) {
  for (Camera head : random_heads(60)) {
    head.position *= 1e5 / glm::length(head.position);
    const EyePair pair = make_rig(head, {});
    for (std::size_t k = 0; k < 2; ++k) ASSERT_LT(worst_error(pair.views[k], pair.cameras[k]), 1e-6);
    // Without an anchor the large translations cancel in fp32.
    EXPECT_GT(worst_error(make_view(pair.cameras[0], glm::vec3(0.0f), near_default), pair.cameras[0]), 1e-4);
  }
}

TEST(Rig, CantedEyesTurnOutwards) {
  const Camera head = head_camera();
  RigSettings settings;
  settings.cant_degrees = 5.0;
  const EyePair pair = make_rig(head, settings);
  EXPECT_FALSE(same_words(pair.views[0].row_z, pair.views[1].row_z));
  EXPECT_TRUE(same_words(pair.views[0].anchor, pair.views[1].anchor));
  const double s = std::sin(glm::radians(5.0));
  EXPECT_NEAR(glm::dot(pair.cameras[0].rotation[2], head.rotation[0]), -s, 1e-12)
      << "the left eye looks left";
  EXPECT_NEAR(glm::dot(pair.cameras[1].rotation[2], head.rotation[0]), s, 1e-12)
      << "the right eye looks right";
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(pair.cameras[k].rotation[1], head.rotation[1]);
    EXPECT_NEAR(glm::determinant(pair.cameras[k].rotation), 1.0, 1e-12);
    // A point 2 m straight ahead of this canted eye lies in the middle of its picture, and off the middle in
    // the other eye's.
    const glm::vec3 p(pair.cameras[k].position + 2.0 * pair.cameras[k].rotation[2]);
    const double side = k == 0 ? -1.0 : 1.0, c = std::cos(glm::radians(5.0));
    const glm::dvec2 flat(side * (0.063 + 2.0 * s),
                          2.0 * c);  // x and z from the other eye, in the head's axes
    const double beside = (c * flat.x + side * s * flat.y) / (-side * s * flat.x + c * flat.y);
    EXPECT_NEAR(pixel(pair.views[k], p).x, head.cx - 0.5, 1e-3);
    EXPECT_NEAR(pixel(pair.views[1 - k], p).x, head.cx - 0.5 + head.fx * beside, 1e-3);
  }
}

TEST(RigFromEyes, ParallelCamerasShareThirdRow) {
  for (const Camera& head : random_heads(120)) {
    const EyePair made = make_rig(head, {});
    Camera left = made.cameras[0], right = made.cameras[1];
    // Text with ten digits has this precision.
    for (int i = 0; i < 3; ++i) right.rotation[i][(i + 1) % 3] += 4e-10;
    const EyePair pair = rig_from_eyes(left, right);
    ASSERT_TRUE(same_words(pair.views[0].row_z, pair.views[1].row_z));
    for (std::size_t k = 0; k < 2; ++k) {
      for (const glm::dvec3& v : {glm::dvec3(0, 0, 1), glm::dvec3(-2, 1, 5)}) {
        const glm::vec3 p = seen_at(head, v);
        ASSERT_LT(glm::length(pixel(pair.views[k], p) - pixel(made.views[k], p)), 2e-3);
      }
    }
  }
}

TEST(RigFromEyes, OtherCamerasKeepRows) {
  const EyePair made = make_rig(head_camera(), {});
  Camera right = made.cameras[1];
  right.position += 1e-6 * right.rotation[2];
  EXPECT_FALSE(share_z(rig_from_eyes(made.cameras[0], right))) << "a micrometre ahead";
  right = made.cameras[1];
  right.rotation =
      glm::dmat3(right.rotation[0], right.rotation[1] + 1e-8 * right.rotation[2], right.rotation[2]);
  EXPECT_FALSE(share_z(rig_from_eyes(made.cameras[0], right))) << "turned by 1e-8";

  RigSettings settings;
  settings.cant_degrees = 5.0;
  const EyePair canted = make_rig(head_camera(), settings);
  const EyePair pair = rig_from_eyes(canted.cameras[0], canted.cameras[1]);
  EXPECT_FALSE(share_z(pair));
  for (std::size_t k = 0; k < 2; ++k) {
    const glm::vec3 p = seen_at(head_camera(), {0.3, -0.2, 2});
    EXPECT_LT(glm::length(pixel(pair.views[k], p) - pixel(canted.views[k], p)), 2e-3);
  }
}

TEST(RigFromEyes, BenchmarkPairsAreParallel) {
  const char* folder = std::getenv("BINOSPLAT_BENCH_VIEWS");
  if (!folder) GTEST_SKIP() << "BINOSPLAT_BENCH_VIEWS does not name a folder with *_bench.json";
  int pairs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".json") continue;
    const std::vector<Camera> cameras = load_cameras(entry.path());
    for (const Camera& camera : cameras) {
      if (!camera.name.ends_with("_left")) continue;
      const auto eyes = find_eyes(cameras, std::string_view(camera.name).substr(0, camera.name.size() - 5));
      ASSERT_TRUE(eyes) << camera.name;
      const EyePair pair = rig_from_eyes((*eyes)[0], (*eyes)[1]);
      EXPECT_TRUE(same_words(pair.views[0].row_z, pair.views[1].row_z)) << camera.name;
      // The right eye is to the right, at the distance that the scenes' page states.
      const double apart = glm::dot((*eyes)[1].position - (*eyes)[0].position, (*eyes)[0].rotation[0]);
      EXPECT_NEAR(apart, entry.path().filename().string().starts_with("fox") ? 0.11 : 0.064, 1e-6)
          << camera.name;
      EXPECT_NEAR((*eyes)[0].fx, apply_preset((*eyes)[0], "headset").fx, 1e-9);
      ++pairs;
    }
  }
  EXPECT_GT(pairs, 0) << folder;
}

TEST(FindEyes, MatchesByName) {
  const EyePair made = make_rig(head_camera(), {});
  const std::vector<Camera> cameras = {made.cameras[1], head_camera(), made.cameras[0]};
  const auto eyes = find_eyes(cameras, "head");
  ASSERT_TRUE(eyes);
  EXPECT_EQ((*eyes)[0].name, "head_left");
  EXPECT_EQ((*eyes)[1].name, "head_right");
  EXPECT_FALSE(find_eyes(cameras, "hea"));
  EXPECT_FALSE(find_eyes({made.cameras[0]}, "head"));
}

TEST(Fov, FrustumMatchesPictureEdges) {
  const Fov fov{-0.9, 0.7, 0.6, -0.8};
  const Camera head = head_camera();
  const Camera camera = camera_from_fov("eye", head.position, head.rotation, fov, 1000, 800);
  const shared::View view = make_view(camera);
  const auto at = [&](double x_angle, double y_angle) {
    return pixel(view, seen_at(head, {std::tan(x_angle), -std::tan(y_angle), 1.0})) + 0.5;
  };
  // The picture's corners, in px from the upper left one: first the upper left, then the lower right.
  EXPECT_LT(glm::length(at(fov.left, fov.up) - glm::dvec2(0, 0)), 1e-3);
  EXPECT_LT(glm::length(at(fov.right, fov.down) - glm::dvec2(1000, 800)), 1e-3);
  EXPECT_GT(glm::length(at(fov.left, fov.down) - glm::dvec2(0, 0)), 1.0)
      << "up taken for down goes unnoticed";
}

TEST(Fov, RejectsEmptyFrustum) {
  const double nan = std::nan("");
  for (const Fov& fov : {Fov{0.9, 0.7, 0.6, -0.8}, Fov{-0.9, 0.7, -0.9, -0.8}, Fov{-1.6, 0.7, 0.6, -0.8},
                         Fov{-0.9, nan, 0.6, -0.8}, Fov{}}) {
    EXPECT_THROW(camera_from_fov("eye", {}, glm::dmat3(1), fov, 10, 10), Error);
  }
}

TEST(Preset, ChangesSizeAndLensOnly) {
  const Camera head = resized(head_camera(), 640, 640);
  const Camera preview = apply_preset(head, "preview");
  EXPECT_EQ(preview.width, 1280);
  EXPECT_EQ(preview.height, 720);
  EXPECT_DOUBLE_EQ(preview.fy / 720, head.fy / 640);
  const Camera headset = apply_preset(head, "headset");
  EXPECT_EQ(headset.width, 3660);
  EXPECT_EQ(headset.height, 3200);
  EXPECT_NEAR(headset.fx, 1535.5523, 1e-4);
  EXPECT_EQ(headset.fx, headset.fy);
  EXPECT_EQ(headset.cx, 1830);
  EXPECT_EQ(headset.position, head.position);
  EXPECT_EQ(headset.rotation, head.rotation);
  EXPECT_THROW(apply_preset(head, "phone"), Error);
}

std::string message(const RigSettings& settings) {
  try {
    make_rig(head_camera(), settings);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    return error.what();
  }
  return "";
}

TEST(Rig, RejectsInvalidValues) {
  const double nan = std::nan("");
  for (double bad : {-0.01, nan, infinitely_far}) EXPECT_TRUE(message({.ipd = bad}).starts_with("ipd "));
  for (double bad : {0.0, -1.0, nan, infinitely_far}) {
    EXPECT_TRUE(message({.units_per_metre = bad}).starts_with("units_per_metre "));
    EXPECT_TRUE(message({.convergence = bad}).starts_with("convergence "));
    EXPECT_TRUE(message({.near_plane = bad}).starts_with("near plane "));
  }
  for (double bad : {45.0, -60.0, nan}) EXPECT_TRUE(message({.cant_degrees = bad}).starts_with("cant "));
  EXPECT_TRUE(message({.convergence = 2.0, .cant_degrees = 3.0}).starts_with("convergence 2 with cant 3"));
  EXPECT_EQ(message({}), "");
}

}  // namespace
}  // namespace binosplat::stereo
