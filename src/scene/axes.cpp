#include "scene/axes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "scene/harmonics.h"

namespace binosplat {

glm::dmat3 world_from_axes(std::string_view letters) {
  constexpr std::string_view directions = "RDFLUB";  // x, y and z of the world, then their opposites
  glm::dmat3 matrix(0.0);
  for (int i = 0; i < 3 && letters.size() == 3; ++i) {
    const auto k = static_cast<int>(directions.find(letters[static_cast<std::size_t>(i)]));
    if (k >= 0) matrix[i][k % 3] = k < 3 ? 1.0 : -1.0;
  }
  if (std::abs(glm::determinant(matrix)) != 1.0) {
    fail(
        "axes '{}': expected three letters, the directions of x, y and z: one of R/L, one of U/D, one of "
        "F/B, as in RDF (COLMAP), RUB (OpenGL) or LUF (glTF)",
        letters);
  }
  return matrix;
}

void bring_into_axes(Model& model, std::string_view letters) {
  const glm::dmat3 turn = glm::transpose(world_from_axes(letters)) * world_from_axes(model.axes.letters);
  model.axes = {std::string(letters), turn * model.axes.origin};
  if (turn == glm::dmat3(1.0)) return;
  const HarmonicsTurn harmonics(turn);
  const double hand = glm::determinant(turn);
  const std::size_t values = 3 * static_cast<std::size_t>(sh_count(model.degree));
  const auto bring = [&](std::size_t i) {
    model.position[i] = turn * glm::dvec3(model.position[i]);
    // D R S S R^T D^T = (D R D^T) (D S S D^T) (D R D^T)^T: D permutes the ellipsoid's axes like the frame's,
    // and a reflection reverses the rotation's axis. No number is rounded.
    model.scale[i] = glm::abs(turn * glm::dvec3(model.scale[i]));
    const glm::vec4 q = model.rotation[i];
    model.rotation[i] = glm::dvec4(q.x, hand * (turn * glm::dvec3(q.y, q.z, q.w)));
    harmonics.apply(&model.sh[i * values], model.degree);
  };
  parallel_for(model.count(), bring, 2048);
}

double orthonormality_error(const glm::dmat3& columns) {
  const glm::dmat3 error = glm::transpose(columns) * columns - glm::dmat3(1.0);
  double largest = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      if (!std::isfinite(error[i][k])) return std::numeric_limits<double>::infinity();
      largest = std::max(largest, std::abs(error[i][k]));
    }
  }
  return largest;
}

glm::dvec3 into_world(const glm::dvec3& point, const ModelAxes& axes) {
  return world_from_axes(axes.letters) * (axes.origin + point);
}

glm::dvec3 into_axes(const glm::dvec3& point, const ModelAxes& axes) {
  return glm::transpose(world_from_axes(axes.letters)) * point - axes.origin;
}

Camera into_axes(Camera camera, const ModelAxes& axes) {
  camera.position = into_axes(camera.position, axes);
  camera.rotation = glm::transpose(world_from_axes(axes.letters)) * camera.rotation;
  return camera;
}

}  // namespace binosplat
