#pragma once
// Measures the colours along fixed rays while a camera turns in place. They should not change.

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/frame.h"
#include "scene/camera.h"

namespace binosplat::measure {

/// Returns the camera turned in place by `radians` about `axis`, a unit vector in the camera's axes.
Camera turned(const Camera& camera, const glm::dvec3& axis, double radians);

/// Returns the point at which a ray from the camera meets the picture; (0, 0) is the centre of the first
/// pixel. NaN if the ray points backward.
glm::dvec2 pixel_of(const Camera& camera, const glm::dvec3& ray);

bool is_inside(const Camera& camera, const glm::dvec2& pixel);

/// Returns the colours over black at points of the camera's picture, each drawn as a view of one pixel.
/// Points may lie between pixel centres.
std::vector<glm::vec3> colours_at(render::Frame& frame, const Camera& camera,
                                  std::span<const glm::dvec2> pixels, const render::FrameSettings& settings,
                                  double near_plane = near_default);

}  // namespace binosplat::measure
