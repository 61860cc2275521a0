#pragma once
// Cameras for a model without any: one that frames it, and a ring around it, in the world (scene/axes.h).

#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "scene/camera.h"
#include "scene/core.h"
#include "scene/ground.h"

namespace binosplat {

/// Default up direction: COLMAP's worlds have y downwards.
constexpr glm::dvec3 default_up{0.0, -1.0, 0.0};

/// Vertical field of view of generated cameras, in degrees.
constexpr double default_fov_degrees = 60.0;

/// Parameters of generated cameras, from known cameras or from the ground. World units.
struct Capture {
  glm::dvec3 up = default_up;  // mean up of the cameras, corrected so that their right axes are level
  /// The point nearest to all camera axes, with the cameras' median distance and median elevation. Unset if
  /// the axes are parallel, or if half of the cameras look more than 30 degrees past the point.
  struct Around {
    glm::dvec3 middle;
    double distance = 0.0;
    double elevation = 0.0;  // radians
    glm::dvec3 first{0.0};   // from the middle to the first camera
  };
  std::optional<Around> around;
};

/// Returns nothing if there are no cameras, or if they have no common up and `up` is not given.
std::optional<Capture> capture_of(std::span<const Camera> cameras, const std::optional<glm::dvec3>& up = {});

/// Returns the capture of a model without cameras, from its ground. If the ground has a floor, the camera
/// stands within the core, `eyes` world units above the floor (less in a tiny model), on the side with the
/// clearest view of the core. If all sides are obstructed, it stands in an open space, if any. Throws Error
/// if the model is empty.
Capture capture_of(const CoredModel& cored, const Ground& ground, double eyes);

/// Finds a place to stand in a model of rooms or streets, which has no single subject. Returns a circle
/// around the middle of the widest open space near the middle of the model. The eyes are `eyes` world units
/// above the ground, which must have a height. The first place on the circle has the longest free line of
/// sight across the space. Returns nothing if no floor has room for a person.
std::optional<Capture::Around> open_space(const CoredModel& cored, const Ground& ground, double eyes);

/// Returns a camera that looks at the core from slightly above, from the side with the clearest view. The
/// core fills the picture. A few far outliers change nothing. If the capture has `around`, the camera stands
/// on that circle instead, in the direction of `first`. Throws Error if the model is empty.
Camera frame_model(const CoredModel& cored, int width, int height, double fov_degrees = default_fov_degrees,
                   const Capture& capture = {});

/// Returns `count` cameras on a circle around the core, named orbit_000 and so on; the first has
/// frame_model's pose. If the capture has `around`, they stand on that circle.
std::vector<Camera> orbit(const CoredModel& cored, int count, int width, int height,
                          double fov_degrees = default_fov_degrees, const Capture& capture = {});

/// Returns near_default, or less for a model so small that near_default would cut into it when framed.
double near_plane_for(const CoredModel& cored);

}  // namespace binosplat
