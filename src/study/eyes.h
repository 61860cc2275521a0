#pragma once
// What the eyes of a pair make of each other's Th, at one error and at as many pairs.

#include <functional>
#include <string>
#include <vector>

#include "study/stability.h"

namespace binosplat::study {

struct EyesResult {
  Variant variant;
  double pairs = 0.0, removed = 0.0;  // of the exact frame's, a share
  double left_db = 0.0, right_db = 0.0;
  double disagreement_db = 0.0;
  double per_eye_db = 0.0;  // both eyes together, of --th-eyes per-eye at as many pairs
  double db = 0.0;          // the same of this rule
};

/// The variant with each --th-eyes, at the loss for `target` dB on a still pair once it has settled.
/// `progress` is called after each.
std::vector<EyesResult> run_eyes(gl::Context& context, const Model& model,
                                 const std::vector<shared::View>& eyes, Variant variant, double target,
                                 const std::function<void()>& progress);

}  // namespace binosplat::study
