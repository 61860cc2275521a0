#pragma once
// Fits colours to pictures. With order, projection, shapes and opacities fixed, a picture is linear in the
// harmonics of its Gaussians, except that colours below 0 are clamped. So refit() solves a least-squares
// problem, by conjugate gradients (Hestenes and Stiefel 1952) on the normal equations. Every few rounds it
// linearises again, because other colours may be clamped.

#include <functional>
#include <optional>
#include <vector>

#include "adagscale/calibrate.h"
#include "base/image.h"
#include "gl/context.h"
#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat::compact {

/// Views of `trim` and `refit`. The model is fitted to the training views, which therefore underestimate its
/// error, so the validation views validate it.
struct ViewSplit {
  std::vector<Camera> training;  // in world coordinates
  std::vector<adagscale::CalibrationView>
      validation;                                // at least one; their mean loss must stay within the bound
  std::vector<adagscale::CalibrationView> test;  // their loss is only reported; may be empty
  // validation and test in the cameras' own size if larger, else empty. The bound must hold in both sizes.
  std::vector<adagscale::CalibrationView> validation_own, test_own;
  double near_plane = near_default;  // world units
};

/// Returns the photo of a camera, RGB at its size, if there is one.
using PhotoOf = std::function<std::optional<Image>(const Camera&)>;

/// The pictures to fit.
struct RefitTargets {
  const Model& original;        // its exact picture, in its order and projection, replaces a missing photo
  std::vector<Camera> cameras;  // in world coordinates
  PhotoOf photo;                // empty if there are no photos
  double near_plane = 0.0;      // world units
};

struct RefitSettings {
  int rounds = 12;          // each draws every target once
  int rounds_linear = 6;    // rounds between linearisations, each of which draws every target once more
  double damping = 0.05;    // keeps changes small; relative to each coefficient's weight in the pictures
  bool keep_zeros = false;  // coefficients above degree 0 that are 0 in all channels stay 0
};

/// Returns a model's loss in validation views, in any unit; called after each round.
using ValidationLoss = std::function<double(const Model&)>;

struct Refitted {
  std::vector<float> sh;       // in Model's layout, after the best round
  std::vector<double> losses;  // before the first round and after each; empty without a validation loss
  int best_round = 0;          // 0: the unchanged model
};

/// Fits the harmonics of `model`, in its order and projection. Ends early after three rounds that do not
/// reduce the validation loss. Without a validation loss the last round counts as the best. Takes about seven
/// times the memory of the harmonics, and holds one picture at a time. Coefficients that affect no target
/// stay. Deterministic. Model and original must have the same axes and no scaffold.
Refitted refit(gl::Context& context, const Model& model, const RefitTargets& targets,
               const RefitSettings& settings, const ValidationLoss& validation_loss);

}  // namespace binosplat::compact
