#pragma once
// Measures the disparity of a stereo pair, and whether it is comfortable.

#include <array>
#include <optional>

#include "base/image.h"
#include "scene/camera.h"

namespace binosplat::stereo {

/// Most people are comfortable with disparities up to this angle from the plane of focus (Lambooij,
/// IJsselsteijn, Fortuin, Heynderickx: Visual Discomfort and Visual Fatigue of Stereoscopic Displays, 2009).
constexpr double comfortable_degrees = 1.0;

/// The range of disparities in a stereo pair. It leaves out the nearest and the farthest hundredth of the
/// pixels, which may be floaters, and pixels without a depth. Numbers are relative to the focus, and positive
/// in front of it.
struct DisparityRange {
  double near_px = 0;    // xL - xR, minus that of the point in focus in the same direction
  double middle_px = 0;  // the median
  double far_px = 0;
  // The angle at a point between the lines to both eyes, minus this angle at the focus in the same direction.
  // A viewer whose eyes are placed like the cameras turns the eyes by this angle.
  double near_degrees = 0;
  double far_degrees = 0;
  double vertical_px = 0;  // the largest |yL - yR| of all pixels with a depth; 0 for parallel eyes
};

/// Distance in world units at which parallel eyes have no disparity. If one screen shows both pictures, this
/// is the distance of the screen. None: infinitely far.
std::optional<double> screen_distance(const std::array<Camera, 2>& eyes);

/// Computes the range from the left eye's picture and its depth. `focus` is the distance in world units at
/// which the eyes focus: screen_distance(), or the focal distance of a headset's optics; none: infinite.
/// Returns none if no pixel has a depth.
std::optional<DisparityRange> disparity_range(const std::array<Camera, 2>& eyes, const Picture& left,
                                              std::optional<double> focus);

/// Whether both ends of a range are within comfortable_degrees.
bool is_comfortable(const DisparityRange& range);

/// A rig for parallel eyes, in world units.
struct ComfortableRig {
  double convergence = 0;
  std::optional<double> ipd;  // none: the eyes' present distance
};

/// Returns the convergence at which the nearest and the farthest point have opposite disparities. If they
/// still exceed comfortable_degrees, also returns a smaller eye distance. For parallel eyes.
ComfortableRig comfortable_rig(const DisparityRange& range, const std::array<Camera, 2>& eyes);

/// Returns a rig for parallel eyes that show depths from `nearest` to `farthest`, in world units: eyes `ipd`
/// apart, or less if the disparities would exceed comfortable_degrees.
ComfortableRig comfortable_rig(double nearest, double farthest, double ipd);

/// Returns a distance of the screen for parallel eyes, in metres of `units_per_metre` world units. By default
/// half of the left eye's pixels are nearer than the screen. If only one end of the range then exceeds
/// comfortable_degrees, the screen moves towards this end, until the end is comfortable or the other end
/// would exceed the limit. Rounds to three digits, so that an option can state the distance. Returns none if
/// no pixel has a finite depth.
std::optional<double> suitable_convergence(const std::array<Camera, 2>& eyes, const Picture& left,
                                           double units_per_metre);

}  // namespace binosplat::stereo
