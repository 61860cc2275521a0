#pragma once
// What a renderer draws along rays, wherever the camera is turned: the same rays from the same place should
// have the same colours.

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/frame.h"
#include "scene/camera.h"

namespace binosplat::measure {

/// The camera turned about its own axes at its place, by `radians` about the unit vector `axis` of its frame.
Camera turned(const Camera& camera, const glm::dvec3& axis, double radians);

/// The unit vector, in the world, from the camera through a point of its picture; (0, 0) is the centre of the
/// first pixel.
glm::dvec3 ray_through(const Camera& camera, const glm::dvec2& pixel);

/// Where a ray from the camera's place meets its picture; no number behind it.
glm::dvec2 pixel_of(const Camera& camera, const glm::dvec3& ray);

/// Whether a point lies in the picture.
bool is_inside(const Camera& camera, const glm::dvec2& pixel);

/// The colours over black that the camera's picture has at these points of it, which need not be centres of
/// pixels. Each is drawn as a picture of one pixel by itself, in frames of MAX_VIEWS.
std::vector<glm::vec3> colours_at(render::Frame& frame, const Camera& camera,
                                  std::span<const glm::dvec2> pixels, const render::FrameSettings& settings,
                                  double near_plane = near_default);

}  // namespace binosplat::measure
