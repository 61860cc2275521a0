#include "formats/cameras/lens.h"

#include <cmath>
#include <glm/gtx/component_wise.hpp>

#include "base/error.h"
#include "base/log.h"
#include "scene/axes.h"

namespace binosplat {

void check_lens(const std::string& where, const Camera& camera) {
  constexpr double max_pixels = 2147483648.0;
  if (camera.width < 1 || camera.height < 1 || static_cast<double>(camera.width) * camera.height > max_pixels)
    fail("{}: a picture of {} x {} px cannot be drawn (from 1 px to 2^31)", where, camera.width,
         camera.height);
  if (!(camera.fx > 0 && camera.fy > 0 && std::isfinite(camera.fx) && std::isfinite(camera.fy)))
    fail("{}: focal lengths of {} and {} px; expected numbers above 0", where, camera.fx, camera.fy);
  if (!std::isfinite(camera.cx) || !std::isfinite(camera.cy))
    fail("{}: the principal point {}, {} is not finite", where, camera.cx, camera.cy);
}

std::string rotation_fault(const glm::dmat3& columns) {
  const double error = orthonormality_error(columns);
  if (!std::isfinite(error)) return "its numbers must be finite";
  if (error > 1e-3)
    return fmt::format("the columns must be orthogonal and of length 1; they are off by {:.3g}", error);
  if (glm::determinant(columns) < 0)
    return "it mirrors (determinant -1); expected x right, y down, z forward";
  return "";
}

std::string make_rotation(const std::string& source, glm::dmat3& columns) {
  const double error = orthonormality_error(columns);
  const glm::dvec3 lengths(glm::length(columns[0]), glm::length(columns[1]), glm::length(columns[2]));
  glm::dmat3 nearest(columns[0] / lengths[0], columns[1] / lengths[1], columns[2] / lengths[2]);
  if (error > 1e-3 && glm::compMax(lengths) < 2.0 * glm::compMin(lengths) &&
      orthonormality_error(nearest) < 0.1) {
    // Newton's iteration for the polar decomposition
    for (int i = 0; i < 6; ++i) nearest = 0.5 * (nearest + glm::inverse(glm::transpose(nearest)));
    columns = nearest;
  }
  std::string fault = rotation_fault(columns);
  if (fault.empty() && error > 0.01)
    log_warning("{}: a camera's axes are rounded or scaled by over 1 %; the nearest rotation is used",
                source);
  return fault;
}

}  // namespace binosplat
