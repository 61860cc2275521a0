#pragma once
// What tests ask of cases of stability.

#include "lab/fixed_camera.h"
#include "support/gl.h"

namespace binosplat::lab {

/// The first pair of a case.
inline FixedCamera first_pair_of(const StabilityCase& one) {
  return {test::gl_context(), *one.model, {one.frames[0].views.begin(), one.frames[0].views.end()}};
}

}  // namespace binosplat::lab
