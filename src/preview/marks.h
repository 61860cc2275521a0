#pragma once
// Lines for orientation: a grid on the ground, the scene's cameras, and the ruler. Pure maths in the world's
// units.

#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat::preview {

struct Line {
  glm::dvec3 from, to;
  glm::vec3 colour;  // display colour
};

inline constexpr glm::vec3 grid_colour{0.45f, 0.70f, 0.85f}, camera_colour{1.0f, 0.62f, 0.1f},
    camera_here_colour{0.35f, 1.0f, 0.35f}, ruler_colour{1.0f, 0.3f, 0.8f};

/// Approximate size and floor of a model. Both take a while to find in a large model.
struct MarkGround {
  glm::dvec3 up{0.0, -1.0, 0.0};  // of length 1
  glm::dvec3 middle{0.0};         // of the model's core
  double radius = 1.0;            // of the core, which contains half of the Gaussians
  std::optional<double> floor;    // height of the floor along `up`
};

MarkGround find_mark_ground(const Model& model, const glm::dvec3& up);

struct MarkPlaces {
  glm::dvec3 up;             // of length 1
  glm::dvec3 middle;         // of the grid, on its plane
  double reach = 1.0;        // distance from the middle to the grid's edge
  double spacing = 1.0;      // between the grid's lines
  double camera_size = 0.1;  // length of a camera's pyramid
};

/// Puts the grid slightly above the model's floor, so that the floor's splats do not cover it; without a
/// floor, below the cameras by the height of eyes. Lines are a metre, or a round number of metres, apart.
MarkPlaces places_of(const MarkGround& ground, std::span<const Camera> cameras, double units_per_metre);

std::vector<Line> grid_lines(const MarkPlaces& places);

/// Returns a pyramid for each camera, with a gable on its upper side; camera `here` has another colour. Skips
/// cameras near `head`, because they would be right before the eyes.
std::vector<Line> camera_lines(std::span<const Camera> cameras, std::size_t here, const glm::dvec3& head,
                               double size);

/// Returns a cross at each of the ruler's points and the line between them, slightly nearer to `head` than
/// the surface, which would cover half of them.
std::vector<Line> ruler_lines(std::span<const glm::dvec3> points, const glm::dvec3& head);

/// A corner of a triangle, as shaders/marks.vert reads it.
struct MarkVertex {
  glm::vec4 place;  // in clip space; z / w as in frustum(near, infinity)
  glm::vec4 colour;
};

/// Converts each line to two triangles, `px` wide in a camera's view and clipped at the near plane.
std::vector<MarkVertex> triangles(std::span<const Line> lines, const Camera& eye, double near_plane,
                                  double px);

}  // namespace binosplat::preview
