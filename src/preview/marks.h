#pragma once
// What is drawn among the splats to find one's way by: a grid on the ground, and the cameras that one steps
// through. Pure maths, in the world (scene/axes.h) and its units.

#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat::preview {

struct Line {
  glm::dvec3 from, to;
  glm::vec3 colour;  // as a screen takes it
};

inline constexpr glm::vec3 grid_colour{0.45f, 0.70f, 0.85f}, camera_colour{1.0f, 0.62f, 0.1f},
    camera_here_colour{0.35f, 1.0f, 0.35f};

/// What they go by: how large a model is about, and its floor, which take a while to find in a large one.
struct MarkGround {
  glm::dvec3 up{0.0, -1.0, 0.0};  // of length 1
  glm::dvec3 middle{0.0};         // of the model
  double radius = 1.0;            // of half of it
  std::optional<double> floor;    // how far along `up` it lies
};

MarkGround find_mark_ground(const Model& model, const glm::dvec3& up);

/// Where marks go and how large they are.
struct MarkPlaces {
  glm::dvec3 up;             // of length 1
  glm::dvec3 middle;         // of the grid, on its plane
  double reach = 1.0;        // how far the grid should go from there
  double spacing = 1.0;      // of its lines
  double camera_size = 0.1;  // how far a camera's picture stands from its eye
};

/// The grid lies on the floor that is found in the model, a little above it, so that the floor's own splats
/// do not cover it in places; without a floor as far below the cameras as a standing head is above the
/// ground. Its lines are a metre apart, or a round number of metres where that makes too many or too few.
MarkPlaces places_of(const MarkGround& ground, std::span<const Camera> cameras, double units_per_metre);

std::vector<Line> grid_lines(const MarkPlaces& places);

/// Pyramids with a gable that tells which way is up, that of camera `here` in another colour. None of a
/// camera that the head is in, where it would be right before both eyes.
std::vector<Line> camera_lines(std::span<const Camera> cameras, std::size_t here, const glm::dvec3& head,
                               double size);

/// A corner of a triangle, as shaders/marks.vert reads it.
struct MarkVertex {
  glm::vec4 place;  // in clip space, where z / w is as frustum(near, infinity) has it
  glm::vec4 colour;
};

/// Lines of so many px as a camera sees them, two triangles for each that lies before its near plane.
std::vector<MarkVertex> triangles(std::span<const Line> lines, const Camera& eye, double near_plane,
                                  double px);

}  // namespace binosplat::preview
