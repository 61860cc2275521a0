#pragma once
// How far the eyes of a pair must turn to fuse it, and whether that is comfortable.

#include <array>
#include <optional>
#include <string>

#include "base/image.h"
#include "scene/camera.h"

namespace binosplat::stereo {

/// Disparities up to this far from the plane that the eyes focus on are comfortable to most (Lambooij,
/// IJsselsteijn, Fortuin, Heynderickx: Visual Discomfort and Visual Fatigue of Stereoscopic Displays, 2009).
constexpr double comfortable_degrees = 1.0;

/// What lies nearest and farthest in a pair, the outermost hundredth of the pixels at either end left out:
/// floaters are no part of the scene. Only pixels with a depth count. Pixels and degrees are both against
/// what the eyes focus on, and positive before it.
struct DisparityRange {
  double near_px = 0;    // xL - xR, less that of what they focus on in the same direction
  double middle_px = 0;  // half of the pixels lie nearer
  double far_px = 0;
  // The angle between the lines from both eyes, less that at what they focus on in the same direction: what
  // the pictures ask of eyes that see them as the cameras did. Positive is nearer.
  double near_degrees = 0;
  double far_degrees = 0;
  double vertical_px = 0;  // the largest |yL - yR| of those pixels; parallel eyes have none
};

/// Distance in world units at which parallel eyes have no disparity, where a screen that shows both stands
/// for the viewer; none: infinitely far.
std::optional<double> screen_distance(const std::array<Camera, 2>& eyes);

/// Finds the range in the left eye's picture and its depth. `focus` is the distance in world units that the
/// eyes focus on, screen_distance() or that of a headset's optics; none: infinite. Nothing where no pixel has
/// a depth.
std::optional<DisparityRange> disparity_range(const std::array<Camera, 2>& eyes, const Picture& left,
                                              std::optional<double> focus);

/// Whether a range lies within comfortable_degrees either way.
bool comfortable(const DisparityRange& range);

/// A rig for parallel eyes, in world units.
struct ComfortableRig {
  double convergence = 0;
  std::optional<double> ipd;  // none: the eyes' own will do
};

/// With which convergence, and if need be which distance between the eyes, these parallel eyes would be
/// comfortable: what is nearest and what is farthest equally far from the screen.
ComfortableRig comfortable_rig(const DisparityRange& range, const std::array<Camera, 2>& eyes);

/// A distance of the screen for parallel eyes, in metres of `units_per_metre` world units: half of the left
/// eye's picture lies nearer, unless another distance brings what is nearest or farthest within
/// comfortable_degrees and leaves the other end there. Rounded to three digits, so that an option can say the
/// same. Nothing where no pixel has a depth, or all that has is infinitely far.
std::optional<double> suitable_convergence(const std::array<Camera, 2>& eyes, const Picture& left,
                                           double units_per_metre);

}  // namespace binosplat::stereo
