#include "stereo/rig.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "scene/axes.h"

namespace binosplat::stereo {

namespace {

/// Two given eyes count as parallel up to this relative deviation, because poses in text files are rounded.
constexpr double parallel_tolerance = 1e-9;

void check_rig(const RigSettings& s) {
  // Each condition also fails for values that are not finite.
  if (!(s.ipd >= 0.0 && std::isfinite(s.ipd))) fail("ipd {}: expected metres, zero or more", s.ipd);
  if (!(s.units_per_metre > 0.0 && std::isfinite(s.units_per_metre))) {
    fail("units_per_metre {}: expected a number above zero", s.units_per_metre);
  }
  if (s.convergence && !(*s.convergence > 0.0 && std::isfinite(*s.convergence))) {
    fail("convergence {}: expected metres above zero; leave it out for parallel eyes", *s.convergence);
  }
  if (!(std::abs(s.cant_degrees) < 45.0))
    fail("cant {}: expected degrees between -45 and 45", s.cant_degrees);
  if (s.convergence && s.cant_degrees != 0.0) {
    fail("convergence {} with cant {}: canted eyes have no common picture plane: leave one of them out",
         *s.convergence, s.cant_degrees);
  }
}

void check_near(double near_plane) {
  if (!(near_plane > 0.0 && std::isfinite(near_plane)))
    fail("near plane {}: expected world units above zero", near_plane);
}

/// Turns a camera about its own y axis: its forward axis moves towards its x axis.
glm::dmat3 turned_right(const glm::dmat3& rotation, double radians) {
  const double c = std::cos(radians), s = std::sin(radians);
  return glm::dmat3(c * rotation[0] - s * rotation[2], rotation[1], s * rotation[0] + c * rotation[2]);
}

/// Returns the view of an eye at `offset` along the head's x axis. It keeps y and z of the head's
/// translation, because y and z from each eye's own position would differ by rounding.
shared::View shifted_view(const Camera& eye, const Camera& head, double offset, const glm::vec3& anchor,
                          double near_plane) {
  shared::View view = make_view(head, anchor, near_plane);
  const double head_x = glm::dot(head.rotation[0], glm::dvec3(anchor) - head.position);
  view.row_x.w = static_cast<float>(head_x - offset);
  view.eye = glm::vec4(glm::vec3(head.position - glm::dvec3(anchor) + offset * head.rotation[0]), 0.0f);
  set_lens(view, eye);
  return view;
}

/// Lets all views sort by the distance from one point, so that the order stays when the head turns about it.
void share_centre(std::span<shared::View> views, const glm::dvec3& centre, const glm::vec3& anchor) {
  for (shared::View& view : views)
    view.centre = glm::vec4(glm::vec3(centre - glm::dvec3(anchor)), view.centre.w);
}

bool are_parallel(const Camera& a, const Camera& b) {
  double turned = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) turned = std::max(turned, std::abs(a.rotation[i][j] - b.rotation[i][j]));
  }
  const double apart = std::abs(glm::dot(a.rotation[2], b.position - a.position));
  const double reach = std::max(glm::length(a.position), glm::length(b.position));
  return turned <= parallel_tolerance && apart <= parallel_tolerance * reach;
}

}  // namespace

EyePair make_rig(const Camera& head, const RigSettings& settings, const ModelAxes& axes) {
  check_rig(settings);
  check_near(settings.near_plane);
  const double half = 0.5 * settings.ipd * settings.units_per_metre;
  const double shift = settings.convergence ? 0.5 * head.fx * settings.ipd / *settings.convergence : 0.0;
  const Camera in_model = into_axes(head, axes);
  const glm::vec3 anchor(in_model.position);
  EyePair pair;
  for (std::size_t k = 0; k < 2; ++k) {
    const double side = k == 0 ? -1.0 : 1.0;
    // Adding to zero makes a zero offset positive, so that the eyes do not differ in the sign of a zero.
    const double offset = 0.0 + side * half;
    Camera& eye = pair.cameras[k];
    eye = head;
    eye.name += k == 0 ? "_left" : "_right";
    eye.position = head.position + offset * head.rotation[0];
    eye.cx = head.cx + side * shift;
    if (settings.cant_degrees == 0.0) {
      pair.views[k] = shifted_view(eye, in_model, offset, anchor, settings.near_plane);
    } else {
      eye.rotation = turned_right(head.rotation, side * glm::radians(settings.cant_degrees));
      pair.views[k] = make_view(into_axes(eye, axes), anchor, settings.near_plane);
    }
  }
  share_centre(pair.views, in_model.position, anchor);
  return pair;
}

std::vector<shared::View> views_of_head(std::span<const Camera> cameras, double near_plane) {
  check_near(near_plane);
  glm::dvec3 middle(0.0);
  for (const Camera& camera : cameras) middle += camera.position;
  middle /= static_cast<double>(cameras.size());
  const glm::vec3 anchor(middle);
  std::vector<shared::View> views;
  for (const Camera& camera : cameras) {
    shared::View& view = views.emplace_back(make_view(camera, anchor, near_plane));
    if (are_parallel(cameras[0], camera)) view.row_z = views[0].row_z;
  }
  share_centre(views, middle, anchor);
  return views;
}

EyePair rig_from_eyes(const Camera& left, const Camera& right, double near_plane, const ModelAxes& axes) {
  const auto views = views_of_head(std::array{into_axes(left, axes), into_axes(right, axes)}, near_plane);
  return {{left, right}, {views[0], views[1]}};
}

std::optional<std::array<Camera, 2>> find_eyes(const std::vector<Camera>& cameras, std::string_view name) {
  const auto find = [&](const char* ending) {
    const std::string wanted = std::string(name) + ending;
    return std::find_if(cameras.begin(), cameras.end(), [&](const Camera& c) { return c.name == wanted; });
  };
  const auto left = find("_left"), right = find("_right");
  if (left == cameras.end() || right == cameras.end()) return std::nullopt;
  return std::array<Camera, 2>{*left, *right};
}

Camera camera_from_fov(std::string name, const glm::dvec3& position, const glm::dmat3& rotation,
                       const Fov& fov, int width, int height) {
  const auto inside = [](double angle) { return std::abs(angle) < glm::radians(90.0); };
  if (!(inside(fov.left) && inside(fov.right) && inside(fov.up) && inside(fov.down) && fov.left < fov.right &&
        fov.down < fov.up)) {
    fail(
        "{}.fov: left {}, right {}, up {}, down {}: expected radians within a quarter turn, left below right "
        "and down below up",
        name, fov.left, fov.right, fov.up, fov.down);
  }
  const double left = std::tan(fov.left), right = std::tan(fov.right);
  const double up = std::tan(fov.up), down = std::tan(fov.down);
  Camera camera;
  camera.name = std::move(name);
  camera.width = width;
  camera.height = height;
  camera.fx = width / (right - left);
  camera.fy = height / (up - down);
  camera.cx = -camera.fx * left;
  camera.cy = camera.fy * up;  // y is down in the picture, up in the angles
  camera.position = position;
  camera.rotation = rotation;
  return camera;
}

Camera apply_preset(const Camera& head, std::string_view preset) {
  if (preset == "preview") return resized(head, 1280, 720);
  Camera camera = head;
  if (preset == "headset") {
    camera.width = 3660;
    camera.height = 3200;
    camera.fx = camera.fy = 0.5 * camera.width / std::tan(glm::radians(50.0));
  } else if (preset == "vr180") {
    camera.width = camera.height = 2048;
    camera.fx = camera.fy = camera.width / glm::radians(180.0);
  } else {
    fail("preset {}: expected preview, headset or vr180", preset);
  }
  camera.cx = 0.5 * camera.width;
  camera.cy = 0.5 * camera.height;
  return camera;
}

}  // namespace binosplat::stereo
