#pragma once
// Cameras for a model that brings none: one that frames it, and a ring of them around it. They are cameras of
// the world (scene/axes.h), whatever the model's frame is.

#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "scene/camera.h"
#include "scene/core.h"
#include "scene/ground.h"

namespace binosplat {

/// What should appear upwards unless the user says otherwise: COLMAP's worlds have y downwards.
constexpr glm::dvec3 default_up{0.0, -1.0, 0.0};

/// Vertical field of view of cameras that the program makes up, in degrees.
constexpr double default_fov_degrees = 60.0;

/// How a scene was captured: what goes for cameras that are made up where others are known. World units.
struct Capture {
  glm::dvec3 up = default_up;  // the mean of theirs, made level across as far as they are
  /// What they stand around, nearest to all their axes, and how far from it and how high above it they are
  /// in the median; nothing where their axes do not meet before them.
  struct Around {
    glm::dvec3 middle;
    double distance = 0.0;
    double elevation = 0.0;  // radians
    glm::dvec3 first{0.0};   // from the middle to the first of them
  };
  std::optional<Around> around;
};

/// Nothing for no cameras, and for those that have no common up, unless `up` says what is up.
std::optional<Capture> capture_of(std::span<const Camera> cameras, const std::optional<glm::dvec3>& up = {});

/// The same for a model without cameras, with the ground that was found in it. In a place, the camera stands
/// on the floor, `eyes` world units above it (less in a tiny model), within the model's core, where the least
/// stands in the way of looking at the core; or, where much does, in an open space. Throws Error if the model
/// is empty.
Capture capture_of(const CoredModel& cored, const Ground& ground, double eyes);

/// Room to stand in, where what a model is about is rooms or streets and not one thing in the middle: a
/// circle to stand on around the middle of the widest open space near the middle of the model, with the eyes
/// `eyes` world units above the ground, which must have a height. Its first place is where one sees farthest
/// across the space. Nothing where there is no floor with room for a person.
std::optional<Capture::Around> open_space(const CoredModel& cored, const Ground& ground, double eyes);

/// A camera that looks at the densest part of the model from slightly above, so far away that the part fills
/// the picture, and from the side where the least stands in the way. A few far outliers change nothing.
/// Or, where there is something `around` which to look, from there. Throws Error if the model is empty.
Camera frame_model(const CoredModel& cored, int width, int height, double fov_degrees = default_fov_degrees,
                   const Capture& capture = {});

/// `count` cameras on a circle around the same part, called orbit_000 and so on; the first is frame_model's.
/// Or on the circle `around` which the scene was captured, from its first camera on.
std::vector<Camera> orbit(const CoredModel& cored, int count, int width, int height,
                          double fov_degrees = default_fov_degrees, const Capture& capture = {});

/// near_default, or less for a model so small that near_default would cut into it when it is framed.
double near_for(const CoredModel& cored);

}  // namespace binosplat
