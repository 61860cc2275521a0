#pragma once
// What both scenes have: heads, bricks, trees and a sky.

#include "demo/shapes.h"
#include "scene/camera.h"

namespace binosplat::demo {

/// A camera of 1,280 x 720 pixels that stands upright.
Camera head_of(const char* name, const dvec3& eye, const dvec3& at, double fov_degrees);

/// Bricks with mortar between them, each of a colour of its own near `colour`.
dvec3 bricks(double u, double v, const dvec3& colour, const dvec3& mortar);

/// A tree with a ball of leaves of this radius. Those that are too small for their grain are left out.
void add_tree(Stage& stage, const dvec3& foot, double radius, const dvec3& colour, double coarseness = 1.0);

/// A dome around the origin, with hills at its foot.
struct Sky {
  double distance, coarseness;
  dvec3 to_sun;                             // the sky is brighter there
  double clouds;                            // another number, other clouds
  bool (*is_seen)(const dvec3& direction);  // the rest is left out
};
void add_sky(Stage& stage, const Sky& sky);

}  // namespace binosplat::demo
