#include "lab/stability_cases.h"

#include <cmath>
#include <functional>

#include "base/random.h"

namespace binosplat::lab {

namespace {

constexpr int width = 128, height = 96;
constexpr double focal = 96.0;
constexpr double sh_c0 = 0.28209479177387814;
constexpr std::size_t sway_frames = 24, still_frames = 300, turn_frames = 30;

void add_gaussian(Model& model, const glm::vec3& position, const glm::vec3& scale, float opacity,
                  const glm::vec3& colour) {
  model.position.push_back(position);
  model.scale.push_back(scale);
  model.rotation.emplace_back(1.0f, 0.0f, 0.0f, 0.0f);
  model.opacity.push_back(opacity);
  for (int c = 0; c < 3; ++c) model.sh.push_back(static_cast<float>((colour[c] - 0.5) / sh_c0));
}

// Gaussians side by side at depth z, beyond the picture's edges: `step` px apart, `size` steps wide,
// coloured by their place in px.
void add_wall(Model& model, double z, double step, double size, float opacity,
              const std::function<glm::vec3(double x, double y)>& colour, double from_x = -0.75 * width) {
  const double unit = z / focal;  // of a px at that depth
  for (double y = -0.75 * height; y <= 0.75 * height; y += step) {
    for (double x = from_x; x <= 0.75 * width; x += step) {
      add_gaussian(model, glm::dvec3(x * unit, y * unit, z),
                   glm::vec3(static_cast<float>(size * step * unit)), opacity, colour(x, y));
    }
  }
}

glm::vec3 random_colour(Random& random) {
  const double r = random.uniform(), g = random.uniform(), b = random.uniform();
  return {r, g, b};
}

glm::vec3 checks(double x, double y) {
  const bool light = (static_cast<int>(std::floor(x / 24)) + static_cast<int>(std::floor(y / 24))) % 2 == 0;
  return light ? glm::vec3(0.8f, 0.7f, 0.5f) : glm::vec3(0.3f, 0.4f, 0.5f);
}

Camera head_at(const glm::dvec3& position, double yaw_degrees) {
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

std::vector<stereo::EyePair> along(const Path& path, std::size_t count,
                                   const stereo::RigSettings& rig = {.ipd = 0.063}) {
  std::vector<stereo::EyePair> frames;
  for (std::size_t n = 0; n < count; ++n) frames.push_back(stereo::make_rig(path(n), rig));
  return frames;
}

// A head that looks about: a third of a degree and 3 mm a frame.
Camera sway(std::size_t frame) {
  const double n = static_cast<double>(frame);
  return head_at({0.003 * n, 0.0, 0.0}, 0.33 * n);
}

Camera still(std::size_t) { return head_at(glm::dvec3(0.0), 0.0); }

StabilityCase make(const char* name, const char* fear, Model model, const Path& path,
                   std::size_t count = sway_frames) {
  model.name = name;
  return {name, fear, std::make_shared<const Model>(std::move(model)), along(path, count), 0};
}

// Half opaque Gaussians of all sizes, many deep.
Model clutter() {
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

Model far_wall() {
  Random random(22);
  Model model;
  add_wall(model, 60.0, 1.0, 0.5, 0.4f,
           [&](double x, double y) { return 0.7f * checks(x, y) + 0.3f * random_colour(random); });
  return model;
}

Model thin_occluder() {
  Model model;
  add_wall(model, 6.0, 5.0, 0.7, 0.9f,
           [](double x, double y) { return glm::vec3(0.6f) + 0.4f * checks(x, y); });
  for (double x = -1.2; x <= 1.2; x += 0.12) {  // dark bars, 1.5 px wide
    for (double y = -1.0; y <= 1.0; y += 0.04)
      add_gaussian(model, glm::dvec3(x, y, 1.5), {0.008f, 0.03f, 0.008f}, 0.95f, glm::vec3(0.05f));
  }
  return model;
}

Model board() {
  Model model;
  add_wall(model, 5.0, 5.0, 0.7, 0.95f, checks);
  add_wall(
      model, 0.8, 5.0, 0.7, 0.97f, [](double, double) { return glm::vec3(0.2f, 0.5f, 0.2f); }, 0.0);
  return model;
}

Model mist() {
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

Model soft_discs() {
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

Model near_cloud() {
  Random random(25);
  Model model;
  for (int i = 0; i < 500; ++i) {
    const double x = random.uniform(-0.6, 0.6), y = random.uniform(-0.5, 0.5), z = random.uniform(0.1, 1.2);
    add_gaussian(model, glm::dvec3(x, y, z), {0.05f, 0.05f, 0.15f}, 0.5f, random_colour(random));
  }
  add_wall(model, 4.0, 6.0, 0.7, 0.95f, checks);
  return model;
}

Model veil() {
  Model model;
  add_wall(model, 4.0, 4.0, 0.7, 0.9f, checks);
  add_gaussian(model, {0.0f, 0.0f, 1.0f}, glm::vec3(3.0f), 0.3f, {0.9f, 0.4f, 0.3f});
  add_gaussian(model, {0.2f, 0.1f, 1.2f}, glm::vec3(4.0f), 0.015f, {0.1f, 0.9f, 0.9f});
  return model;
}

}  // namespace

std::vector<StabilityCase> built_in_cases() {
  std::vector<StabilityCase> cases;
  cases.push_back(
      make("far-wall", "tiny far Gaussians, each below Th and together a wall (trap 1)", far_wall(), sway));
  cases.push_back(make("thin-occluder", "bars that uncover a bright field as the head moves (trap 4)",
                       thin_occluder(), [](std::size_t n) {
                         return head_at({0.008 * static_cast<double>(n), 0.0, 0.0}, 0.0);
                       }));
  cases.push_back(make("one-eye", "a board that hides from one eye what the other sees (trap 4)", board(),
                       [](std::size_t n) {
                         return head_at({0.004 * static_cast<double>(n), 0.0, 0.0}, 0.0);
                       }));
  cases.push_back(make("still", "a camera that does not move: the loop must settle and not drift (trap 3)",
                       clutter(), still, still_frames));
  cases.push_back(make("mist", "a mostly transparent model: nothing hides anything", mist(), sway));
  cases.push_back(
      make("tile-edges", "soft discs whose tails end at a tile's edge (trap 5)", soft_discs(), sway));
  cases.push_back(
      make("near-plane", "a cloud that the head moves through (trap 6)", near_cloud(), [](std::size_t n) {
        return head_at({0.0, 0.0, 0.01 * static_cast<double>(n)}, 0.0);
      }));
  cases.push_back(make("all-tiles", "one Gaussian over all tiles, before a wall (trap 7)", veil(), sway));
  return cases;
}

std::vector<StabilityCase> cases_in(std::shared_ptr<const Model> scene, const Camera& head,
                                    const stereo::RigSettings& rig) {
  const auto turned = [&head](double degrees) {
    Camera camera = head;
    const double a = glm::radians(degrees), c = std::cos(a), s = std::sin(a);
    camera.rotation[0] = c * head.rotation[0] - s * head.rotation[2];
    camera.rotation[2] = s * head.rotation[0] + c * head.rotation[2];
    return camera;
  };
  constexpr double a_frame_at_90_hz = 200.0 / 90.0;
  const std::size_t jump = turn_frames / 2;
  StabilityCase cut{
      "jump", "a 30 degree jump of the camera (trap 4)", scene,
      along([&](std::size_t n) { return turned(0.1 * static_cast<double>(n) + (n < jump ? 0 : 30)); },
            turn_frames, rig),
      jump};
  StabilityCase turn{"fast-turn", "200 degrees/s at 90 Hz, there and back (trap 4)", scene,
                     along(
                         [&](std::size_t n) {
                           const double there =
                               std::min<double>(static_cast<double>(n), turn_frames - static_cast<double>(n));
                           return turned(a_frame_at_90_hz * there);
                         },
                         turn_frames, rig),
                     0};
  return {std::move(cut), std::move(turn)};
}

}  // namespace binosplat::lab
