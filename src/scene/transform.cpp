#include "scene/transform.h"

#include <Eigen/SVD>
#include <atomic>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <optional>

#include "base/parallel.h"
#include "scene/harmonics.h"

namespace binosplat {

namespace {

// Relative tolerance for equal scales, and absolute for no rotation: files store transforms as floats.
constexpr double uniform_tolerance = 1e-6;

/// Views a glm matrix as an Eigen one: both store columns.
Eigen::Map<const Eigen::Matrix3d> to_eigen(const glm::dmat3& m) {
  return Eigen::Map<const Eigen::Matrix3d>(&m[0][0]);
}

glm::dmat3 from_eigen(const Eigen::Matrix3d& matrix) { return glm::make_mat3(matrix.data()); }

Eigen::JacobiSVD<Eigen::Matrix3d> decomposed(const glm::dmat3& m) {
  return Eigen::JacobiSVD<Eigen::Matrix3d>(to_eigen(m), Eigen::ComputeFullU | Eigen::ComputeFullV);
}

glm::dquat quaternion(const glm::vec4& wxyz) { return {wxyz.x, wxyz.y, wxyz.z, wxyz.w}; }

glm::vec4 wxyz(const glm::dquat& q) { return glm::dvec4(q.w, q.x, q.y, q.z); }

/// Returns the rotation of orthogonal axes, negated if they include a reflection (the ellipsoid is equal).
glm::dquat quaternion_of(const glm::dmat3& orthogonal) {
  return glm::normalize(glm::quat_cast(glm::determinant(orthogonal) < 0.0 ? -orthogonal : orthogonal));
}

/// Transforms an ellipsoid: M and C = R diag(scale) give M C = U diag(s) V^T, with axes U and scales s. The
/// covariance would square the scales, and thin Gaussians would lose half their digits.
void map_ellipsoid(const glm::dmat3& linear, glm::vec4& rotation, glm::vec3& scale) {
  glm::dmat3 axes = linear * glm::mat3_cast(quaternion(rotation));
  for (int c = 0; c < 3; ++c) axes[c] *= scale[c];
  const auto svd = decomposed(axes);
  for (int k = 0; k < 3; ++k) scale[k] = static_cast<float>(svd.singularValues()[k]);
  rotation = wxyz(quaternion_of(from_eigen(svd.matrixU())));
}

}  // namespace

bool transform(Model& model, const glm::dmat4& map, std::vector<glm::dvec3>& places) {
  const glm::dmat3 linear(map);
  if (!to_eigen(linear).allFinite()) return false;
  const auto svd = decomposed(linear);
  const double largest = svd.singularValues()[0], smallest = svd.singularValues()[2];
  glm::dmat3 q = from_eigen(svd.matrixU() * svd.matrixV().transpose());
  // If M flattens, it has no handedness: use a rotation.
  if (smallest <= uniform_tolerance * largest && glm::determinant(q) < 0.0)
    q = from_eigen(svd.matrixU() * Eigen::Vector3d(1, 1, -1).asDiagonal() * svd.matrixV().transpose());
  const bool even = largest - smallest <= uniform_tolerance * largest;
  const bool turns = (to_eigen(q) - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > uniform_tolerance;
  const glm::dquat turn = quaternion_of(q);
  const double size = svd.singularValues()[1];
  std::optional<HarmonicsTurn> harmonics;  // only if needed: takes as long as transforming a small model
  if (turns && model.degree > 0) harmonics.emplace(q);
  const std::size_t values = 3 * static_cast<std::size_t>(sh_count(model.degree));
  std::atomic<bool> good = true;
  const std::size_t before = places.size();
  places.resize(before + model.count());
  const auto move = [&](std::size_t i) {
    places[before + i] = glm::dvec3(map * glm::dvec4(model.position[i], 1.0));
    model.position[i] = places[before + i];
    if (!even) {
      map_ellipsoid(linear, model.rotation[i], model.scale[i]);
    } else {
      model.scale[i] = glm::dvec3(model.scale[i]) * size;
      if (turns) model.rotation[i] = wxyz(turn * quaternion(model.rotation[i]));
    }
    if (harmonics) harmonics->apply(&model.sh[i * values], model.degree);
    if (!glm::all(glm::lessThan(glm::abs(model.position[i]), glm::vec3(INFINITY))) ||
        !glm::all(glm::lessThanEqual(model.scale[i], glm::vec3(1e13f))))  // as of files: place()
      good = false;
  };
  parallel_for(model.count(), move, 2048);
  return good;
}

}  // namespace binosplat
