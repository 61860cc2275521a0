#pragma once
// Colours along rays while the camera turns in place: equal rays should keep their colours.

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/frame.h"
#include "scene/camera.h"

namespace binosplat::measure {

/// The camera turned in place by `radians` about `axis`, a unit vector in its own frame.
Camera turned(const Camera& camera, const glm::dvec3& axis, double radians);

/// The unit vector, in the world, from the camera through a point of its picture. (0, 0) is the centre of the
/// first pixel.
glm::dvec3 ray_through(const Camera& camera, const glm::dvec2& pixel);

/// The point of the picture on a ray from the camera; NaN if the ray points backward.
glm::dvec2 pixel_of(const Camera& camera, const glm::dvec3& ray);

/// Whether the picture contains a point.
bool is_inside(const Camera& camera, const glm::dvec2& pixel);

/// The colours over black at points of the camera's picture, which may lie between pixels. Draws each point
/// as a picture of one pixel, in frames of MAX_VIEWS.
std::vector<glm::vec3> colours_at(render::Frame& frame, const Camera& camera,
                                  std::span<const glm::dvec2> pixels, const render::FrameSettings& settings,
                                  double near_plane = near_default);

}  // namespace binosplat::measure
