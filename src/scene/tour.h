#pragma once
// Camera paths of a head that visits a model's cameras, for videos and for benchmarks of moving views.

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "scene/camera.h"

namespace binosplat {

/// Returns the cameras in their order. Each stereo pair, NAME_left and NAME_right, becomes the head between
/// its eyes, at the index of the first of the two.
std::vector<Camera> heads_from_pairs(std::span<const Camera> cameras);

/// The highest speed and rotation rate of a head. A head takes at least 0.15 s from rest to either limit, and
/// every other change of velocity is as gradual.
struct Motion {
  std::string name;
  double metres_per_second = 0.0;
  double degrees_per_second = 0.0;
};

/// Returns the named motions: calm (0.23 m/s, 28 degrees/s), walk (0.51, 82) and fast (0.76, 183). These are
/// the median, the 90th and the 99th percentile of 22 people in 12 scenes (EyeNavGS, arXiv 2506.02380).
const std::vector<Motion>& head_motions();

/// Estimates a metre in world units if no scale is known: photographers move about a step between two photos.
/// Returns the median distance of a camera to its nearest neighbour at another place, or 1 for fewer than two
/// places. Eyes of a pair count as one head (heads_from_pairs()), as in tours.
double estimated_metre(std::span<const Camera> cameras);

struct TourSettings {
  Motion motion;
  double frames_per_second = 90.0;
  double units_per_metre = 1.0;                              // world units
  double seconds = std::numeric_limits<double>::infinity();  // longer tours are cut here
};

/// Returns the cameras of a head that visits all `cameras`, one a frame, with `time`. The tour begins with
/// the first camera and orders the others so that no reversal of a section would shorten it. That order
/// depends on neither the list's order nor the motion. The head follows a path (scene/key_path.h) through the
/// cameras and through more keys on a smooth path between them, as fast as the motion allows. It walks evenly
/// and turns in saccades, as people do. It exceeds the motion's limits by at most one per cent. Skips cameras
/// within 1 cm and 1 degree of another. All frames have the first camera's lens and size. All settings must
/// be above 0. Throws Error for fewer than two cameras, cameras of one pose, tours of 1e9 s or more, and more
/// than a million frames.
std::vector<Camera> tour(std::span<const Camera> cameras, const TourSettings& settings);

}  // namespace binosplat
