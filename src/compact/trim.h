#pragma once
// Finds the smallest model whose pictures stay within a bound, in three steps. Each step is a search that is
// validated in views other than the training views.

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "compact/refit.h"
#include "formats/model_output.h"
#include "lab/calibrate.h"

namespace binosplat::compact {

/// A model as read back from its file, and the file's size.
struct WrittenModel {
  Model model;
  std::uintmax_t bytes = 0;
};

/// Writes a model to a file of the requested format and reads it back.
using TrialWriter = std::function<WrittenModel(const Model&, int harmonic_bits)>;

/// The model after one step.
struct TrimStep {
  std::string name;  // the last change
  std::size_t gaussians = 0;
  int degree = 0;
  std::uintmax_t bytes = 0;
  lab::Calibrator::Cost held_back;
  lab::Calibrator::Cost test;  // all 0 without test views
  // At the cameras' own size, if the views are smaller (ViewSplit).
  std::optional<lab::Calibrator::Cost> held_back_own, test_own;

  /// Returns the value that the bound limits: the lower mean PSNR of both sizes. Drops exist at one size
  /// only.
  double bounded_db() const {
    return held_back_own ? std::min(held_back.mean_db, held_back_own->mean_db) : held_back.mean_db;
  }
};

struct Trimmed {
  Model model;                  // to write, with
  int harmonic_bits = 8;        // of spz
  bool format_fits = true;      // false: the format alone exceeds the bound, and nothing was removed
  bool is_smaller = false;      // something was removed, or colours were fitted
  std::size_t unseen = 0;       // Gaussians that touch no pixel of the training views
  std::vector<TrimStep> steps;  // from the whole model on, which has no file and so no bytes
};

/// Settings of trim().
struct TrimSettings {
  CalibrationTarget target;  // the allowed mean loss in the validation views
  ModelFormat format = ModelFormat::ply;
  TrialWriter write;
  std::optional<PhotoOf> refit;  // fit colours to these photos, or to the model's own pictures
};

/// Spends the bound in this order. A quarter: as few bits as the format offers (spz). Another quarter:
/// harmonics that change colours least, first by a lower degree for all, then, if the format packs zeros
/// (spz), for as many Gaussians as possible. The rest, at least half: the Gaussians whose removal changes the
/// pictures least. Training views determine these changes; the bound limits the mean over the validation
/// views, at both sizes if they have two. Every candidate is judged as read back from its file, so the bound
/// holds for the written file. The model has the format's axes and no scaffold. Throws Error for views in
/// which a target cannot be measured (Calibrator).
Trimmed trim(gl::Context& context, const Model& model, const lab::ViewSplit& views,
             const TrimSettings& settings);

}  // namespace binosplat::compact
