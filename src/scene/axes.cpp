#include "scene/axes.h"

#include <cmath>

#include "base/error.h"

namespace binosplat {

namespace {

/// A direction in the world; zero for a letter that names none.
glm::dvec3 direction(char letter) {
  switch (letter) {
    case 'R':
      return {1, 0, 0};
    case 'L':
      return {-1, 0, 0};
    case 'D':
      return {0, 1, 0};
    case 'U':
      return {0, -1, 0};
    case 'F':
      return {0, 0, 1};
    case 'B':
      return {0, 0, -1};
    default:
      return {0, 0, 0};
  }
}

}  // namespace

glm::dmat3 world_from_axes(std::string_view letters) {
  glm::dmat3 matrix(0.0);
  for (int i = 0; i < 3 && letters.size() == 3; ++i)
    matrix[i] = direction(letters[static_cast<std::size_t>(i)]);
  if (std::abs(glm::determinant(matrix)) != 1.0) {
    fail(
        "axes '{}': expected three letters for x, y and z, of R or L, U or D, F or B, each pair once, as in "
        "RDF "
        "(COLMAP), RUB (OpenGL) or LUF (glTF)",
        letters);
  }
  return matrix;
}

Camera into_axes(Camera camera, std::string_view letters) {
  const glm::dmat3 into = glm::transpose(world_from_axes(letters));
  camera.position = into * camera.position;
  camera.rotation = into * camera.rotation;
  return camera;
}

}  // namespace binosplat
