#include "scene/framing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "base/parallel.h"
#include "base/statistics.h"
#include "scene/axes.h"

namespace binosplat {

namespace {

/// Angle from which cameras look down on the model, unless known cameras give another.
constexpr double elevation_degrees = 15.0;
/// Larger models are sampled to measure obstruction.
constexpr std::size_t framing_sample = 200000;

/// A circle around the core, or around the captured point, in the model's frame.
struct Ring {
  Core core;
  const ModelAxes& axes;
  glm::dvec3 up;
  std::array<glm::dvec3, 2> level;
  double distance = 0.0;
  double elevation = glm::radians(elevation_degrees);

  Ring(const CoredModel& cored, int width, int height, double fov_degrees, const glm::dvec3& wanted_up,
       const std::optional<Capture::Around>& around)
      : core(cored.core), axes(cored.model.axes), up(glm::normalize(wanted_up)), level(level_directions(up)) {
    for (glm::dvec3* direction : {&up, &level[0], &level[1]}) *direction = from_world(*direction);
    const double tan_y = std::tan(0.5 * glm::radians(fov_degrees));
    const double half_angle = std::atan(std::min(tan_y, tan_y * width / height));
    distance = core.radius / std::sin(half_angle);
    if (!around) return;
    core.middle = into_axes(around->middle, axes);
    distance = around->distance;
    elevation = around->elevation;
  }

  glm::dvec3 from_world(const glm::dvec3& direction) const {
    return glm::transpose(world_from_axes(axes.letters)) * direction;
  }

  /// Returns the angle on the ring, in radians, of the world direction `away` from the middle.
  double turn_to(const glm::dvec3& away) const {
    const glm::dvec3 there = from_world(away);
    return std::atan2(glm::dot(there, level[0]), glm::dot(there, level[1]));
  }

  glm::dvec3 eye(double turn) const {
    return core.middle +
           distance * (std::sin(elevation) * up +
                       std::cos(elevation) * (std::cos(turn) * level[1] + std::sin(turn) * level[0]));
  }
};

/// Returns the obstruction of the view from `eye` to the core, in sr: solid angle times opacity, summed over
/// the Gaussians in the nearer half of the distance.
double obstruction(const Model& model, const Ring& ring, const glm::dvec3& eye) {
  const glm::dvec3 forward = (ring.core.middle - eye) / ring.distance;
  const std::size_t stride = model.count() / framing_sample + 1;
  double sum = 0.0;
  for (std::size_t i = 0; i < model.count(); i += stride) {
    const glm::dvec3 v = glm::dvec3(model.position[i]) - eye;
    const double z = glm::dot(v, forward);
    const double square = glm::dot(v, v);
    // Within 45 degrees of the middle of the picture.
    if (z <= 0.0 || z > 0.5 * ring.distance || square > 2.0 * z * z) continue;
    glm::vec3 s = model.scale[i];
    std::sort(&s.x, &s.x + 3);
    sum += model.opacity[i] * std::min(1.0, static_cast<double>(s.y) * s.z / square);
  }
  return sum * static_cast<double>(stride);
}

/// The place on a ring with the clearest view.
struct Clearest {
  double turn = 0.0;        // radians
  double obstructed = 0.0;  // sr
};

/// Returns the clearest of 16 places on the ring, the first among equals. Obstructions are rounded down to
/// multiples of 0.02 sr, one per cent of the examined cone, so that noise does not decide.
Clearest clearest_on(const Model& model, const Ring& ring) {
  constexpr int places = 16;
  std::array<double, places> found{};
  parallel_for(places, [&](int k) {
    const glm::dvec3 eye = ring.eye(glm::two_pi<double>() * k / places);
    found[static_cast<std::size_t>(k)] = 0.02 * std::floor(obstruction(model, ring, eye) / 0.02);
  });
  const auto best = std::min_element(found.begin(), found.end());
  return {glm::two_pi<double>() * static_cast<double>(best - found.begin()) / places, *best};
}

// Finds the point x nearest to the axes of cameras at p that look along f: sum of (1 - f f^T) (x - p) = 0.
std::optional<Capture::Around> around_of(std::span<const Camera> cameras, const glm::dvec3& up) {
  glm::dmat3 across{0.0};
  glm::dvec3 places{0.0};
  for (const Camera& camera : cameras) {
    const glm::dvec3 forward = camera.rotation[2];
    const glm::dmat3 of_one = glm::dmat3(1.0) - glm::outerProduct(forward, forward);
    across += of_one;
    places += of_one * camera.position;
  }
  const double count = static_cast<double>(cameras.size());
  constexpr double parallel = 1e-3;  // the determinant is at most 8/27, with axes in all directions
  if (glm::determinant(across) < parallel * count * count * count) return std::nullopt;
  Capture::Around around{glm::inverse(across) * places};
  std::vector<double> distances, heights, facing;
  for (const Camera& camera : cameras) {
    const glm::dvec3 away = camera.position - around.middle;
    distances.push_back(std::max(glm::length(away), 1e-9));
    heights.push_back(std::asin(std::clamp(glm::dot(away, up) / distances.back(), -1.0, 1.0)));
    facing.push_back(-glm::dot(away, camera.rotation[2]) / distances.back());
  }
  constexpr double half_look_there = 0.866;  // cosine of 30 degrees
  if (!(quantile(facing, 0.5) > half_look_there)) return std::nullopt;
  around.first = cameras[0].position - around.middle;
  around.distance = quantile(distances, 0.5);
  around.elevation = quantile(heights, 0.5);
  return around;
}

}  // namespace

std::optional<Capture> capture_of(std::span<const Camera> cameras, const std::optional<glm::dvec3>& up) {
  if (up && !cameras.empty()) return Capture{glm::normalize(*up), around_of(cameras, glm::normalize(*up))};
  glm::dvec3 sum{0.0};
  for (const Camera& camera : cameras) sum -= camera.rotation[1];
  constexpr double common = 0.3;
  if (cameras.empty() || glm::length(sum) < common * static_cast<double>(cameras.size())) return std::nullopt;
  // People hold cameras level but tilt them up and down. So up is as perpendicular as possible to the right
  // axes r, and otherwise near the mean up. It minimises mean (r . u)^2 + near (u - mean)^2.
  constexpr double near = 0.01;
  glm::dmat3 across(near);
  for (const Camera& camera : cameras)
    across += glm::outerProduct(camera.rotation[0], camera.rotation[0]) / static_cast<double>(cameras.size());
  const glm::dvec3 found = glm::normalize(glm::inverse(across) * sum);
  return Capture{found, around_of(cameras, found)};
}

Capture capture_of(const CoredModel& cored, const Ground& ground, double eyes) {
  Capture capture{ground.up};
  if (!ground.height) return capture;
  const Core& core = cored.core;
  constexpr double highest = 0.7;  // height of the eyes in core radii, for a model no larger than a person
  const double eyes_at = *ground.height + std::min(eyes, highest * core.radius);
  constexpr double crowded = 0.2;  // sr, of the 1.8 sr that obstruction() examines
  std::optional<double> least;
  for (const double away : {0.9, 0.6, 0.4}) {
    Capture::Around around{into_world(core.middle, cored.model.axes)};
    const double height = eyes_at - glm::dot(around.middle, ground.up);
    around.distance = std::hypot(away * core.radius, height);
    around.elevation = std::atan2(height, away * core.radius);
    const Ring ring(cored, 1, 1, default_fov_degrees, ground.up, around);
    const Clearest clearest = clearest_on(cored.model, ring);
    if (least && *least <= clearest.obstructed) continue;
    least = clearest.obstructed;
    around.first = into_world(ring.eye(clearest.turn), cored.model.axes) - around.middle;
    capture.around = around;
  }
  if (*least > crowded) {
    if (const auto open = open_space(cored, ground, eyes_at - *ground.height)) capture.around = open;
  }
  return capture;
}

std::vector<Camera> orbit(const CoredModel& cored, int count, int width, int height, double fov_degrees,
                          const Capture& capture) {
  const auto& [up, around] = capture;
  const Ring ring(cored, width, height, fov_degrees, up, around);
  const double start = around ? ring.turn_to(around->first) : clearest_on(cored.model, ring).turn;
  std::vector<Camera> cameras;
  for (int k = 0; k < count; ++k) {
    const glm::dvec3 eye = into_world(ring.eye(start + glm::two_pi<double>() * k / count), ring.axes);
    cameras.push_back(look_at(eye, into_world(ring.core.middle, ring.axes), up, fov_degrees, width, height));
    cameras.back().name = fmt::format("orbit_{:03}", k);
  }
  return cameras;
}

Camera frame_model(const CoredModel& cored, int width, int height, double fov_degrees,
                   const Capture& capture) {
  Camera camera = orbit(cored, 1, width, height, fov_degrees, capture)[0];
  camera.name = "framed";
  return camera;
}

double near_plane_for(const CoredModel& cored) {
  // A framed model starts about one radius from the camera. At a tenth of a radius, the near plane leaves
  // room to come closer.
  return std::min(near_default, 0.1 * cored.core.radius);
}

}  // namespace binosplat
