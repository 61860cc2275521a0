#pragma once
// Parts of both scenes: heads, bricks, trees and a sky.

#include "demo/shapes.h"
#include "scene/camera.h"

namespace binosplat::demo {

/// Returns an upright camera of 1,280 x 720 px.
Camera head_of(const char* name, const dvec3& eye, const dvec3& at, double fov_degrees);

/// Returns the colour of a brick wall with mortar; each brick has its own colour near `colour`.
dvec3 bricks(double u, double v, const dvec3& colour, const dvec3& mortar);

/// Adds a tree with a ball of leaves of this radius. Leaves that are too small for their grain are omitted.
void add_tree(SceneBuilder& stage, const dvec3& foot, double radius, const dvec3& colour,
              double coarseness = 1.0);

/// A dome around the origin, with hills at its foot.
struct Sky {
  double distance, coarseness;
  dvec3 to_sun;                             // the sky is brighter there
  double clouds;                            // a seed of the clouds
  bool (*is_seen)(const dvec3& direction);  // parts that are never seen are omitted
};
void add_sky(SceneBuilder& stage, const Sky& sky);

}  // namespace binosplat::demo
