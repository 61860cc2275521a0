#pragma once
// A head that goes through a model's cameras: paths for videos, and to measure on what moves.

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "scene/camera.h"

namespace binosplat {

/// The cameras in their order, where both eyes of a pair, NAME_left and NAME_right, are the one head between
/// them, in the place of the first of the two.
std::vector<Camera> heads_of(std::span<const Camera> cameras);

/// How fast a head goes and how fast it turns at most. From rest to full speed, or to turn so, it takes 0.15
/// s at least, and no other change of its velocity is quicker.
struct Motion {
  std::string name;
  double metres_per_second = 0.0;
  double degrees_per_second = 0.0;
};

/// What heads do: calm (0.3 m/s, 12 degrees a second), walk (1.5, 45), fast (6, 200: turns, and what a head
/// does not do, for what must hold all the same).
const std::vector<Motion>& head_motions();

/// World units that may be taken for a metre where no scale is known, as who takes photos goes about a step
/// between two: from each camera to its nearest neighbour elsewhere, in the median. 1 for fewer than two
/// places. Eyes of a pair count as one head (heads_of()), as in tours.
double metre_of(std::span<const Camera> cameras);

struct TourSettings {
  Motion motion;
  double frames_per_second = 90.0;
  double units_per_metre = 1.0;                              // world units
  double seconds = std::numeric_limits<double>::infinity();  // the tour is cut off there
};

/// The cameras of a head that goes through all of `cameras`, one a frame, with `time`. It begins with the
/// first; of the others' order it is known that no part of it would be shorter backwards, and it depends
/// neither on that of the list nor on the motion. The head follows the path (scene/key_path.h) through keys
/// on a smooth way through the cameras, among them the cameras themselves, and goes from each key to the next
/// as fast as the motion allows: never more than one per cent faster. Cameras within 1 cm and 1 degree of
/// another are left out. All have the first camera's lens and size. Speeds, frames a second, units and
/// seconds must be above 0. Throws Error for fewer than two cameras, all of one pose, tours of 1e9 s or more,
/// and more than a million frames.
std::vector<Camera> tour(std::span<const Camera> cameras, const TourSettings& settings);

}  // namespace binosplat
