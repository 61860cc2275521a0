#pragma once
// Measures the disparity of a pair of pictures, and whether it is comfortable.

#include <array>
#include <optional>
#include <string>

#include "base/image.h"
#include "scene/camera.h"

namespace binosplat::stereo {

/// Most people are comfortable with disparities up to this angle from the plane of focus (Lambooij,
/// IJsselsteijn, Fortuin, Heynderickx: Visual Discomfort and Visual Fatigue of Stereoscopic Displays, 2009).
constexpr double comfortable_degrees = 1.0;

/// The nearest and farthest disparities of a pair, without the outermost hundredth of the pixels at either
/// end, which may be floaters. Only pixels with a depth count. Pixels and degrees are relative to the focus,
/// and positive in front of it.
struct DisparityRange {
  double near_px = 0;    // xL - xR, minus that of the focus in the same direction
  double middle_px = 0;  // the median
  double far_px = 0;
  // The angle between the lines from both eyes, minus that at the focus in the same direction. The viewer's
  // eyes must turn by this if they are placed as the cameras were. Positive is nearer.
  double near_degrees = 0;
  double far_degrees = 0;
  double vertical_px = 0;  // the largest |yL - yR| of these pixels; 0 for parallel eyes
};

/// Distance in world units at which parallel eyes have no disparity: the screen's, if one screen shows both.
/// None: infinitely far.
std::optional<double> screen_distance(const std::array<Camera, 2>& eyes);

/// Computes the range from the left eye's picture and its depth. `focus` is the distance in world units on
/// which the eyes focus: screen_distance(), or that of a headset's optics; none: infinite. None if no pixel
/// has a depth.
std::optional<DisparityRange> disparity_range(const std::array<Camera, 2>& eyes, const Picture& left,
                                              std::optional<double> focus);

/// Whether both ends of a range are within comfortable_degrees.
bool is_comfortable(const DisparityRange& range);

/// A rig for parallel eyes, in world units.
struct ComfortableRig {
  double convergence = 0;
  std::optional<double> ipd;  // none: keep the eyes' own
};

/// The convergence that makes these parallel eyes comfortable: the nearest and the farthest point get
/// opposite disparities. If that is not enough, also a smaller distance between the eyes.
ComfortableRig comfortable_rig(const DisparityRange& range, const std::array<Camera, 2>& eyes);

/// A distance of the screen for parallel eyes, in metres of `units_per_metre` world units. Half of the left
/// eye's picture is nearer. Another distance is chosen if it brings one end of the range within
/// comfortable_degrees and keeps the other there. Rounded to three digits, so that an option can state it.
/// None if no pixel has a finite depth.
std::optional<double> suitable_convergence(const std::array<Camera, 2>& eyes, const Picture& left,
                                           double units_per_metre);

}  // namespace binosplat::stereo
