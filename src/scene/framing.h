#pragma once
// Cameras for a model without any: one that frames it, and a ring around it, in the world (scene/axes.h).

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "scene/camera.h"
#include "scene/core.h"

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

/// Tangents of half of a picture's angles.
struct PictureShape {
  double tan_x = 1.0, tan_y = 1.0;
};

PictureShape shape_of(const Camera& camera);

/// How to look at a model without cameras.
struct Viewpoint {
  enum class Kind {
    whole,   // from outside; the whole model is in the picture
    within,  // as a person who stands on the floor of a scene
    core,    // from outside of the core of a scene
  };
  Kind kind = Kind::whole;
  Capture capture;           // with `around`
  bool up_by_floor = false;  // `up` is the floor's
  double eyes = 0.0;         // height above the floor, world units; only for `within`
};

/// Finds how to look at a model. A scene, which goes on behind a viewer too, is seen from within, from `eyes`
/// world units above its floor (less in a tiny model). All else is seen from outside, whole, without its
/// floaters; a relief is seen along its thin axis. Without `up`, the up direction is the world's, or that of
/// a floor. `wanted` leaves no choice: the whole of the model, or its core. Throws Error if the model is
/// empty.
Viewpoint find_viewpoint(const CoredModel& cored, const PictureShape& shape,
                         const std::optional<glm::dvec3>& up = {}, double eyes = 1.6,
                         std::optional<Viewpoint::Kind> wanted = {});

/// Returns whether any camera shows something of the model, from a place that is not within its surfaces.
bool any_camera_sees(std::span<const Camera> cameras, const CoredModel& cored);

/// Returns the nearest and the farthest depth of what cameras show of a model, in world units, without the
/// nearest and the farthest five hundredth; of many cameras it looks at some. Hidden parts count, too.
/// Returns nothing if they show nothing.
std::optional<std::array<double, 2>> depths_seen(std::span<const Camera> cameras, const CoredModel& cored);

/// Returns `count` cameras on the circle of a capture that has `around`, named orbit_000 and so on.
std::vector<Camera> orbit(const Capture& capture, int count, int width, int height,
                          double fov_degrees = default_fov_degrees);

/// Returns the first camera of a capture that has `around`, named framed.
Camera first_camera(const Capture& capture, int width, int height, double fov_degrees = default_fov_degrees);

/// Returns the first camera of find_viewpoint().
Camera frame_model(const CoredModel& cored, int width, int height, double fov_degrees = default_fov_degrees,
                   const std::optional<glm::dvec3>& up = {});

/// Returns the near plane of the training, or near_default, or less for a model so small that near_default
/// would cut into it when framed.
double near_plane_for(const CoredModel& cored);

}  // namespace binosplat
