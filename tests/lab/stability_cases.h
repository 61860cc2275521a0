#pragma once
// Where thresholds that go by the last frame can fail (docs/method.md 7), each as a small scene and a path.

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/random.h"
#include "scene/camera.h"
#include "scene/model.h"
#include "stereo/rig.h"

namespace binosplat::lab {

struct StabilityCase {
  std::string name;
  std::shared_ptr<const Model> model;
  std::vector<stereo::EyePair> frames;
  std::size_t event = 0;  // the frame from which settling is counted: 0, or the one after a jump
};

namespace stability {

constexpr int width = 128, height = 96;
constexpr double focal = 96.0;
constexpr double sh_c0 = 0.28209479177387814;
constexpr std::size_t sway_frames = 24, still_frames = 90, turn_frames = 30;

inline void add_gaussian(Model& model, const glm::vec3& position, const glm::vec3& scale, float opacity,
                         const glm::vec3& colour) {
  model.position.push_back(position);
  model.scale.push_back(scale);
  model.rotation.emplace_back(1.0f, 0.0f, 0.0f, 0.0f);
  model.opacity.push_back(opacity);
  for (int c = 0; c < 3; ++c) model.sh.push_back(static_cast<float>((colour[c] - 0.5) / sh_c0));
}

// Gaussians side by side at depth z, beyond the picture's edges: `step` px apart, `size` steps wide,
// coloured by their place in px.
inline void add_wall(Model& model, double z, double step, double size, float opacity,
                     const std::function<glm::vec3(double x, double y)>& colour,
                     double from_x = -0.75 * width) {
  const double unit = z / focal;  // of a px at that depth
  for (double y = -0.75 * height; y <= 0.75 * height; y += step) {
    for (double x = from_x; x <= 0.75 * width; x += step) {
      add_gaussian(model, glm::dvec3(x * unit, y * unit, z),
                   glm::vec3(static_cast<float>(size * step * unit)), opacity, colour(x, y));
    }
  }
}

inline glm::vec3 random_colour(Random& random) {
  const double r = random.uniform(), g = random.uniform(), b = random.uniform();
  return {r, g, b};
}

inline glm::vec3 checks(double x, double y) {
  const bool light = (static_cast<int>(std::floor(x / 24)) + static_cast<int>(std::floor(y / 24))) % 2 == 0;
  return light ? glm::vec3(0.8f, 0.7f, 0.5f) : glm::vec3(0.3f, 0.4f, 0.5f);
}

inline Camera head_at(const glm::dvec3& position, double yaw_degrees) {
  Camera camera;
  camera.name = "head";
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = focal;
  camera.cx = width / 2.0;
  camera.cy = height / 2.0;
  camera.position = position;
  const double a = glm::radians(yaw_degrees), c = std::cos(a), s = std::sin(a);
  camera.rotation = glm::dmat3(c, 0, -s, 0, 1, 0, s, 0, c);
  return camera;
}

using Path = std::function<Camera(std::size_t frame)>;

inline std::vector<stereo::EyePair> along(const Path& path, std::size_t count,
                                          const stereo::RigSettings& rig = {.ipd = 0.063}) {
  std::vector<stereo::EyePair> frames;
  for (std::size_t n = 0; n < count; ++n) frames.push_back(stereo::make_rig(path(n), rig));
  return frames;
}

// A head that looks about: a third of a degree and 3 mm a frame.
inline Camera sway(std::size_t frame) {
  const double n = static_cast<double>(frame);
  return head_at({0.003 * n, 0.0, 0.0}, 0.33 * n);
}

inline Camera still(std::size_t) { return head_at(glm::dvec3(0.0), 0.0); }

inline StabilityCase make(const char* name, Model model, const Path& path, std::size_t count = sway_frames) {
  return {name, std::make_shared<const Model>(std::move(model)), along(path, count), 0};
}

// Half opaque Gaussians of all sizes, many deep.
inline Model clutter() {
  Random random(21);
  Model model;
  for (int i = 0; i < 3000; ++i) {
    const double z = random.uniform(0.8, 6.0);
    const double x = random.uniform(-0.9, 0.9) * z, y = random.uniform(-0.7, 0.7) * z;
    const double a = std::exp(random.uniform(-5.5, -2.2)), b = std::exp(random.uniform(-5.5, -2.2));
    const double opacity = random.uniform(0.1, 1.0);
    add_gaussian(model, glm::dvec3(x, y, z), glm::dvec3(a, b, a), static_cast<float>(opacity),
                 random_colour(random));
  }
  add_wall(model, 8.0, 6.0, 0.7, 0.95f, checks);
  return model;
}

inline Model far_wall() {
  Random random(22);
  Model model;
  add_wall(model, 60.0, 1.0, 0.5, 0.4f,
           [&](double x, double y) { return 0.7f * checks(x, y) + 0.3f * random_colour(random); });
  return model;
}

inline Model thin_occluder() {
  Model model;
  add_wall(model, 6.0, 5.0, 0.7, 0.9f,
           [](double x, double y) { return glm::vec3(0.6f) + 0.4f * checks(x, y); });
  for (double x = -1.2; x <= 1.2; x += 0.12) {  // dark bars, 1.5 px wide
    for (double y = -1.0; y <= 1.0; y += 0.04)
      add_gaussian(model, glm::dvec3(x, y, 1.5), {0.008f, 0.03f, 0.008f}, 0.95f, glm::vec3(0.05f));
  }
  return model;
}

inline Model board() {
  Model model;
  add_wall(model, 5.0, 5.0, 0.7, 0.95f, checks);
  add_wall(
      model, 0.8, 5.0, 0.7, 0.97f, [](double, double) { return glm::vec3(0.2f, 0.5f, 0.2f); }, 0.0);
  return model;
}

inline Model mist() {
  Random random(23);
  Model model;
  for (int i = 0; i < 6000; ++i) {
    const double z = random.uniform(1.0, 8.0);
    const double x = random.uniform(-0.8, 0.8) * z, y = random.uniform(-0.6, 0.6) * z;
    add_gaussian(model, glm::dvec3(x, y, z), glm::vec3(static_cast<float>(0.05 * z)), 0.03f,
                 random_colour(random));
  }
  return model;
}

inline Model soft_discs() {
  Random random(24);
  Model model;
  for (int i = 0; i < 60; ++i) {
    const double z = random.uniform(2.0, 5.0);
    const double x = random.uniform(-0.6, 0.6) * z, y = random.uniform(-0.45, 0.45) * z;
    add_gaussian(model, glm::dvec3(x, y, z), glm::vec3(static_cast<float>(0.12 * z)), 0.6f,
                 random_colour(random));
  }
  return model;
}

inline Model near_cloud() {
  Random random(25);
  Model model;
  for (int i = 0; i < 500; ++i) {
    const double x = random.uniform(-0.6, 0.6), y = random.uniform(-0.5, 0.5), z = random.uniform(0.1, 1.2);
    add_gaussian(model, glm::dvec3(x, y, z), {0.05f, 0.05f, 0.15f}, 0.5f, random_colour(random));
  }
  add_wall(model, 4.0, 6.0, 0.7, 0.95f, checks);
  return model;
}

inline Model veil() {
  Model model;
  add_wall(model, 4.0, 4.0, 0.7, 0.9f, checks);
  add_gaussian(model, {0.0f, 0.0f, 1.0f}, glm::vec3(3.0f), 0.3f, {0.9f, 0.4f, 0.3f});
  add_gaussian(model, {0.2f, 0.1f, 1.2f}, glm::vec3(4.0f), 0.015f, {0.1f, 0.9f, 0.9f});
  return model;
}

}  // namespace stability

/// The built-in cases; each is 128 x 96 px an eye.
inline std::vector<StabilityCase> built_in_cases() {
  using namespace stability;
  const auto at_speed = [](const glm::dvec3& units_a_frame) -> Path {
    return [units_a_frame](std::size_t n) { return head_at(static_cast<double>(n) * units_a_frame, 0.0); };
  };
  return {// Tiny far Gaussians, each below Th and together a wall (trap 1).
          make("far-wall", far_wall(), sway),
          // Bars that uncover a bright field as the head moves (trap 4).
          make("thin-occluder", thin_occluder(), at_speed({0.008, 0.0, 0.0})),
          // A board that hides from one eye what the other sees (trap 4).
          make("one-eye", board(), at_speed({0.004, 0.0, 0.0})),
          // A camera that does not move: the loop must settle and not drift (trap 3).
          make("still", clutter(), still, still_frames),
          // A mostly transparent model: nothing hides anything.
          make("mist", mist(), sway),
          // Soft discs whose tails end at a tile's edge (trap 5).
          make("tile-edges", soft_discs(), sway),
          // A cloud that the head moves through (trap 6).
          make("near-plane", near_cloud(), at_speed({0.0, 0.0, 0.01})),
          // One Gaussian over all tiles, before a wall (trap 7).
          make("all-tiles", veil(), sway)};
}

/// A 30 degree jump and a fast turn of 200 degrees/s at 90 Hz, there and back, in any scene (trap 4).
inline std::vector<StabilityCase> cases_in(const std::shared_ptr<const Model>& scene, const Camera& head,
                                           const stereo::RigSettings& rig) {
  using namespace stability;
  const auto turned = [&head](double degrees) {
    Camera camera = head;
    const double a = glm::radians(degrees), c = std::cos(a), s = std::sin(a);
    camera.rotation[0] = c * head.rotation[0] - s * head.rotation[2];
    camera.rotation[2] = s * head.rotation[0] + c * head.rotation[2];
    return camera;
  };
  constexpr double a_frame_at_90_hz = 200.0 / 90.0;
  constexpr std::size_t jump = turn_frames / 2;
  const auto jumping = [&](std::size_t n) {
    return turned(0.1 * static_cast<double>(n) + (n < jump ? 0 : 30));
  };
  const auto turning = [&](std::size_t n) {
    return turned(a_frame_at_90_hz * static_cast<double>(std::min(n, turn_frames - n)));
  };
  return {{"jump", scene, along(jumping, turn_frames, rig), jump},
          {"fast-turn", scene, along(turning, turn_frames, rig), 0}};
}

}  // namespace binosplat::lab
