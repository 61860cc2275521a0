#include "formats/lens.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace binosplat {

void check_lens(const std::string& where, const Camera& camera) {
  constexpr double most_pixels = 2147483648.0;
  if (camera.width < 1 || camera.height < 1 ||
      static_cast<double>(camera.width) * camera.height > most_pixels)
    fail("{}: a picture of {} x {} px cannot be drawn (from 1 px to 2^31)", where, camera.width,
         camera.height);
  if (!(camera.fx > 0 && camera.fy > 0 && std::isfinite(camera.fx) && std::isfinite(camera.fy)))
    fail("{}: focal lengths of {} and {} px; expected numbers above 0", where, camera.fx, camera.fy);
  if (!std::isfinite(camera.cx) || !std::isfinite(camera.cy))
    fail("{}: the principal point {}, {} is not finite", where, camera.cx, camera.cy);
}

std::string rotation_fault(const glm::dmat3& columns) {
  const glm::dmat3 square = glm::transpose(columns) * columns;
  double largest = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double off = std::abs(square[i][j] - (i == j ? 1.0 : 0.0));
      if (!std::isfinite(off)) return "its numbers must be finite";
      largest = std::max(largest, off);
    }
  }
  if (!(largest <= 1e-3))
    return fmt::format("the columns must be orthogonal and of length 1; they are off by {:.3g}", largest);
  if (glm::determinant(columns) < 0)
    return "it mirrors (determinant -1); expected x right, y down, z forward";
  return "";
}

}  // namespace binosplat
