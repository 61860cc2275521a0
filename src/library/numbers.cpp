#include "library/numbers.h"

#include <cmath>

#include "base/error.h"
#include "scene/axes.h"
#include "shared/limits.h"

namespace binosplat::library {

namespace {

template <typename Vector>
bool is_finite(const Vector& v) {
  for (int k = 0; k < v.length(); ++k) {
    if (!std::isfinite(v[k])) return false;
  }
  return true;
}

/// Whether the columns are orthonormal, up to rounding.
bool are_directions(const glm::dmat3& axes) { return orthonormality_error(axes) < 1e-3; }

}  // namespace

void check_numbers(std::span<const View> views, const Placement& placement) {
  if (views.empty() || views.size() > MAX_VIEWS)
    fail("a frame has 1 to {} views, not {}", MAX_VIEWS, views.size());
  const glm::dvec3& origin = placement.origin;
  if (!is_finite(origin)) {
    fail("placement.origin ({}, {}, {}): expected finite world units", origin.x, origin.y, origin.z);
  }
  if (!are_directions(placement.axes))
    fail("placement.axes: expected three directions of length 1 at right angles to each other, as columns");
  if (!(placement.units_per_metre > 0.0) || !std::isfinite(placement.units_per_metre))
    fail("placement.units_per_metre {}: expected a number above zero", placement.units_per_metre);
  for (std::size_t k = 0; k < views.size(); ++k) {
    const Eye& eye = views[k].eye;
    const glm::dvec3& p = eye.position;
    // The GPU computes in floats: check the rounded position, too.
    if (!is_finite(p) || !is_finite(glm::vec3(origin + placement.units_per_metre * (placement.axes * p))))
      fail("views[{}].eye.position ({}, {}, {}): expected finite metres", k, p.x, p.y, p.z);
    const glm::dvec4& q = eye.orientation;
    if (!is_finite(q) || q == glm::dvec4(0.0)) {
      fail(
          "views[{}].eye.orientation ({}, {}, {}, {}): expected a finite quaternion x, y, z, w that is not "
          "zero",
          k, q.x, q.y, q.z, q.w);
    }
  }
}

void check_numbers(const Instance& instance, const std::string& name) {
  if (!are_directions(instance.rotation))
    fail("{}.rotation: expected three columns of length 1 at right angles to each other", name);
  if (!is_finite(glm::vec3(instance.translation))) fail("{}.translation: expected finite world units", name);
  if (!(instance.scale > 0.0) || !std::isfinite(static_cast<float>(instance.scale)))
    fail("{}.scale {}: expected a number above zero", name, instance.scale);
  if (!(instance.opacity >= 0.0f && instance.opacity <= 1.0f))
    fail("{}.opacity {}: expected 0 to 1", name, instance.opacity);
}

}  // namespace binosplat::library
