#pragma once
// Removes as much of a model as the allowed loss permits, in three steps. Each step searches the largest
// removal whose loss in the validation views stays within the bound.

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "adagscale/calibrate.h"
#include "compact/refit.h"
#include "formats/models/model_output.h"

namespace binosplat::compact {

/// A model as read back from its file, and the file's size.
struct WrittenModel {
  Model model;
  std::uintmax_t bytes = 0;
};

/// Writes a model to a file of the requested format and reads it back.
using TrialWriter = std::function<WrittenModel(const Model&, int harmonic_bits)>;

struct TrimStep {
  std::string name;  // describes the step's change
  std::size_t gaussians = 0;
  int degree = 0;
  std::uintmax_t bytes = 0;
  adagscale::Calibrator::Cost validation;
  adagscale::Calibrator::Cost test;  // all 0 without test views
  // The same costs at the cameras' own size, if the views are smaller (ViewSplit).
  std::optional<adagscale::Calibrator::Cost> validation_own, test_own;

  /// Returns the value that the bound limits: the lower mean PSNR of both sizes. Drops have one size only.
  double bounded_db() const {
    return validation_own ? std::min(validation.mean_db, validation_own->mean_db) : validation.mean_db;
  }
};

struct Trimmed {
  Model model;                  // the trimmed model
  int harmonic_bits = 8;        // bits per harmonic with which to write it as spz
  bool format_fits = true;      // false: the format alone exceeds the bound, and nothing was removed
  bool is_smaller = false;      // something was removed, or colours were fitted
  std::size_t unseen = 0;       // Gaussians that touch no pixel of the training views
  std::vector<TrimStep> steps;  // the first one is the original model, which has no file and 0 bytes
};

struct TrimSettings {
  adagscale::CalibrationTarget target;  // the allowed mean loss in the validation views: the bound
  ModelFormat format = ModelFormat::ply;
  TrialWriter write;
  std::optional<PhotoOf> refit;  // if set: fits colours to these photos, or to the model's exact pictures
};

/// Spends the allowed loss in three steps:
/// - up to a quarter for fewer bits per harmonic (spz only);
/// - up to half, with the first step, for lower degrees of harmonics: one degree for all Gaussians, then (spz
///   only, which packs zeros) lower degrees for the Gaussians whose colours change least;
/// - the rest for removing the Gaussians whose removal changes the pictures least.
/// Changes are measured in the training views. The bound limits the mean loss in the validation views, at
/// both sizes if there are two. Every candidate is measured as read back from its file, so the bound holds
/// for the written file. The model must have the format's axes and no scaffold. Throws Error for views in
/// which a target cannot be measured (Calibrator).
Trimmed trim(gl::Context& context, const Model& model, const ViewSplit& views, const TrimSettings& settings);

}  // namespace binosplat::compact
