#pragma once
// The stereo rig: from one head camera (or two given eyes) to the two Views of a frame. Pure maths, in double
// until the Views are rounded to float. docs/method.md 6.
//
// Units: `ipd` and `convergence` are metres; `units_per_metre` brings them to the world's units. Everything
// else (positions, near plane) is in world units already. Eye 0 is the left one, eye 1 the right one.

#include <binosplat/eyes.h>
#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scene/camera.h"
#include "shared/types.h"

namespace binosplat::stereo {

struct RigSettings {
  double ipd = 0.063;                 // m, distance between the eyes' centres
  double units_per_metre = 1.0;       // world units that make a metre
  std::optional<double> convergence;  // m, depth of zero disparity; none: infinitely far
  double cant_degrees = 0.0;          // each eye turned outwards about its own y axis; negative: inwards
  double near_plane = near_default;   // world units
};

struct EyePair {
  std::array<Camera, 2> cameras;      // named NAME_left and NAME_right
  std::array<shared::View, 2> views;  // both have one anchor; the frame fills in tiles, offsets and groups
  bool parallel = true;  // the views' third rows are equal to the bit: both are projected together
};

/// The eyes of a head: at head.position -+ x axis * ipd / 2. Parallel eyes (no cant) share their y and z rows
/// to the bit and differ by the translation along x and, with a convergence distance D, by off-axis frusta:
/// left cx - fx ipd / (2 D), right cx + fx ipd / (2 D), so that a point at depth z has the disparity xL - xR
/// = fx ipd (1/z - 1/D). At ipd 0 both views are equal bit for bit. Throws Error, naming the option, for a
/// value that makes no rig; so does a convergence distance for canted eyes, whose pictures no shift brings
/// onto one plane.
EyePair make_rig(const Camera& head, const RigSettings& settings);

/// The rig of two cameras given as a pair. Where their rotations are equal within 1e-9 and their z
/// translations within 1e-9 of their distance from the origin, they are parallel and the left's third row
/// serves both.
EyePair rig_from_eyes(const Camera& left, const Camera& right, double near_plane = near_default);

/// The views of a head's cameras, two or more, the same way: those that are parallel to the first share its
/// third row, all are of one anchor, and sorted by distance from the point between them all.
struct HeadViews {
  std::vector<shared::View> views;
  bool parallel = true;  // all to the first
};
HeadViews views_of_head(std::span<const Camera> cameras, double near_plane = near_default);

/// The cameras called NAME_left and NAME_right, or nothing if either is missing.
std::optional<std::array<Camera, 2>> find_eyes(const std::vector<Camera>& cameras, std::string_view name);

/// The camera of a pose and a frustum; `rotation` has the axes x right, y down, z forward as columns (an
/// OpenXR pose has y up and z backward: negate its second and third columns). Throws Error for angles that
/// enclose no picture.
Camera camera_from_fov(std::string name, const glm::dvec3& position, const glm::dmat3& rotation,
                       const Fov& fov, int width, int height);

/// The head camera with the size and lens of `--preset`: "preview" is 1,280 x 720 an eye and keeps the
/// vertical field of view; "headset" is 3,660 x 3,200 an eye, 100 degrees across, square pixels, centred;
/// "vr180" has the size of a panorama, 2,048 x 2,048 an eye, and a pixel in the middle as wide as one of it.
/// Pose, name and time are kept.
Camera apply_preset(const Camera& head, std::string_view preset);

}  // namespace binosplat::stereo
