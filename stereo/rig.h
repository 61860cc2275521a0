#pragma once
// The stereo rig: derives the two Views of a frame from one head camera (or two given eyes). Pure maths in
// double, until the Views are rounded to float. docs/method.md 6.
//
// Units: `ipd` and `convergence` are in metres; `units_per_metre` converts them to world units. All else
// (positions, near plane) is in world units. Eye 0 is the left one, eye 1 the right one.

#include <binosplat/eyes.h>
#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scene/camera.h"
#include "scene/model.h"
#include "shared/types.h"

namespace binosplat::stereo {

struct RigSettings {
  double ipd = 0.063;  // m, distance between the eyes' centres
  double units_per_metre = 1.0;
  std::optional<double> convergence;  // m, depth of zero disparity; none: infinite
  double cant_degrees = 0.0;          // each eye turns outwards about its own y axis; negative: inwards
  double near_plane = near_default;   // world units
};

struct EyePair {
  std::array<Camera, 2> cameras;      // named NAME_left and NAME_right; in the world, as the head
  std::array<shared::View, 2> views;  // share one anchor (method.md 1); Frame adds tiles, offsets, groups
};

/// The eyes of a head: at head.position -+ x axis * ipd / 2. The view matrices of parallel eyes (no cant)
/// have bit-equal y and z rows and differ in the translation along x. With a convergence distance D, parallel
/// eyes also have off-axis frusta: left cx - fx ipd / (2 D), right cx + fx ipd / (2 D). A point at depth z
/// then has the disparity xL - xR = fx ipd (1/z - 1/D). At ipd 0 both views are bit-equal. Throws Error,
/// which names the setting, for an illegal value. A convergence distance for canted eyes is illegal, because
/// no shift brings their pictures onto one plane. The views are those of a model with `axes`.
EyePair make_rig(const Camera& head, const RigSettings& settings, const ModelAxes& axes = {});

/// The rig of two given cameras. They are parallel if the elements of their rotations differ by at most 1e-9,
/// and their positions along z by at most 1e-9 times the farther camera's distance from the origin. Parallel
/// cameras both use the left one's z axis. The views are those of a model with `axes`.
EyePair rig_from_eyes(const Camera& left, const Camera& right, double near_plane = near_default,
                      const ModelAxes& axes = {});

/// The views of a head's cameras. Views parallel to the first share its z axis (row_z), so that all are
/// projected together. All share one anchor. With Order::distance, all sort by the distance from the midpoint
/// of all cameras.
std::vector<shared::View> views_of_head(std::span<const Camera> cameras, double near_plane = near_default);

/// The cameras named NAME_left and NAME_right; none if either is missing.
std::optional<std::array<Camera, 2>> find_eyes(const std::vector<Camera>& cameras, std::string_view name);

/// The camera of a pose and a frustum. `rotation` has the axes x right, y down, z forward as columns (an
/// OpenXR pose has y up and z backward: negate its second and third columns). Throws Error if the
/// angles span no picture, such as a left angle that is not less than the right one.
Camera camera_from_fov(std::string name, const glm::dvec3& position, const glm::dmat3& rotation,
                       const Fov& fov, int width, int height);

/// The head camera with the size and lens of `--preset`. "preview" is 1,280 x 720 an eye and keeps the
/// vertical field of view. "headset" is 3,660 x 3,200 an eye, 100 degrees across, with square pixels,
/// centred. "vr180" has the size of a panorama, 2,048 x 2,048 an eye. Its middle pixel covers the same angle
/// as a pixel of the panorama. Keeps pose, name and time.
Camera apply_preset(const Camera& head, std::string_view preset);

}  // namespace binosplat::stereo
