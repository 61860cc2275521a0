#pragma once
// Colours that fit pictures best. With order, projection, shapes and opacities fixed, a picture is linear in
// the harmonics of its Gaussians, but for colours below 0, which are 0: least squares, by conjugate gradients
// (Hestenes and Stiefel 1952) on the normal equations, linearised anew every few rounds.

#include <functional>
#include <optional>
#include <vector>

#include "base/image.h"
#include "gl/context.h"
#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat::compact {

/// The photo of a camera, RGB in its size; or none.
using PhotoOf = std::function<std::optional<Image>(const Camera&)>;

/// The pictures that a model should draw.
struct RefitTargets {
  const Model& original;        // where there is no photo: its exact pictures, in its own perspective
  std::vector<Camera> cameras;  // of the world
  PhotoOf photo;                // may be empty
  double near_plane = 0.0;      // world units
};

struct RefitSettings {
  int rounds = 12;          // each draws every target once
  int rounds_linear = 6;    // after so many it is linearised anew, which draws every target once more
  double damping = 0.05;    // of changes, in shares of what each coefficient weighs in the pictures
  bool keep_zeros = false;  // coefficients beyond the constant ones that are 0 in all channels stay 0
};

/// How far the model is from what is wanted, in any unit, in views that have no say; asked after each round.
using RefitJudge = std::function<double(const Model&)>;

struct Refitted {
  std::vector<float> sh;       // as Model has them, after the best round
  std::vector<double> judged;  // before the first round, and after each; empty without a judge
  int best_round = 0;          // 0: the model as it was
};

/// Fits the harmonics of `model`, in the perspective that it names; it ends early where it gets no better.
/// The best round is the last where there is no judge. Takes about seven times the memory of the harmonics,
/// and none for pictures: one is drawn or read at a time. A coefficient of which no target shows anything
/// stays. The same bits always. Model and original have the same axes, and are not Scaffold-GS's.
Refitted refit(gl::Context& context, const Model& model, const RefitTargets& targets,
               const RefitSettings& settings, const RefitJudge& judge);

}  // namespace binosplat::compact
