#pragma once
// Models of flat Gaussians that lie in surfaces, as trained models do.

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#define GLM_ENABLE_EXPERIMENTAL
#include <glm/gtx/quaternion.hpp>
#include <random>

#include "support/models.h"

namespace binosplat::test {

/// Surfaces of flat Gaussians with slightly random normals, at random positions in rectangles.
struct Surfaces {
  Model model;
  std::mt19937 random{1};

  double next(double low, double high) { return std::uniform_real_distribution(low, high)(random); }

  /// Adds the rectangle of `across` and `along` at a corner. `thick` is the smallest scale relative to the
  /// others.
  void add(const glm::dvec3& corner, const glm::dvec3& across, const glm::dvec3& along, int count,
           float thick = 0.1f) {
    const glm::dvec3 normal = glm::normalize(glm::cross(across, along));
    for (int i = 0; i < count; ++i) {
      const glm::dvec3 n = glm::normalize(normal + 0.1 * glm::dvec3(next(-1, 1), next(-1, 1), next(-1, 1)));
      // The shortest axis, z, is along the normal.
      const glm::dquat q = glm::rotation(glm::dvec3(0, 0, 1), n);
      const glm::dvec3 place = corner + next(0, 1) * across + next(0, 1) * along;
      binosplat::test::add(model, place, {0.1f, 0.1f, 0.1f * thick}, 0.9f, glm::vec3(0.5f),
                           {q.w, q.x, q.y, q.z});
    }
  }
};

/// Returns a lawn of 20 x 20 around the origin, z up, with a table in the middle and a hedge on one side.
inline Model garden(float thick = 0.1f) {
  Surfaces out;
  out.add({-10, -10, 0}, {20, 0, 0}, {0, 20, 0}, 6000, thick);
  out.add({-1, -1, 0.8}, {2, 0, 0}, {0, 2, 0}, 800, thick);
  out.add({-10, 9, 0}, {20, 0, 0}, {0, 0, 2}, 1500, thick);
  return out.model;
}

/// Returns a room of 6 x 5 x 2.6, one of many in a flat: four walls, floor, ceiling, a cupboard.
inline Model furnished_room(const glm::dvec3& at = {}) {
  Surfaces out;
  const glm::dvec3 x(6, 0, 0), y(0, 5, 0), z(0, 0, 2.6);
  for (const glm::dvec3& corner : {glm::dvec3(0), z}) out.add(at + corner, x, y, 3000);
  for (const glm::dvec3& corner : {glm::dvec3(0), y}) out.add(at + corner, x, z, 1500);
  for (const glm::dvec3& corner : {glm::dvec3(0), x}) out.add(at + corner, y, z, 1300);
  out.add(at + glm::dvec3(0, 1, 0), {0.6, 0, 0}, {0, 0, 1}, 300);
  out.add(at + glm::dvec3(0, 1, 1), {0.6, 0, 0}, {0, 1, 0}, 300);
  return out.model;
}

}  // namespace binosplat::test
