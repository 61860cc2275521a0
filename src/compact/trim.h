#pragma once
// Finds the smallest model whose pictures stay within a bound, in three steps. Each is a search whose result
// is judged in views that were not used to choose what goes.

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "compact/refit.h"
#include "formats/model_output.h"
#include "lab/calibrate.h"

namespace binosplat::compact {

/// A model as its file keeps it, and the bytes of that file.
struct WrittenModel {
  Model model;
  std::uintmax_t bytes = 0;
};

/// Writes a model to a file of the wanted format and reads it back.
using TrialWriter = std::function<WrittenModel(const Model&, int harmonic_bits)>;

/// The model after one step.
struct TrimStep {
  std::string name;  // what was done last
  std::size_t gaussians = 0;
  int degree = 0;
  std::uintmax_t bytes = 0;
  lab::Calibrator::Cost held_back;
  lab::Calibrator::Cost test;  // all 0 without such views
  // In the cameras' own size, where the views are smaller (ViewSplit).
  std::optional<lab::Calibrator::Cost> held_back_own, test_own;

  /// What the bound is on: the mean of the size that loses more; a PSNR, as a drop is of one size.
  double worse_db() const {
    return held_back_own ? std::min(held_back.mean_db, held_back_own->mean_db) : held_back.mean_db;
  }
};

struct Trimmed {
  Model model;             // what to write, with
  int harmonic_bits = 8;   // of spz
  bool fits = true;        // the bound allows for what the format itself costs; else nothing was left out
  bool less = false;       // anything could be left out, or colours fitted
  std::size_t unseen = 0;  // Gaussians that touch no pixel of the training views
  std::vector<TrimStep> steps;  // from the whole model on, which has the bytes of no file
};

/// How to trim.
struct TrimSettings {
  CalibrationTarget target;  // what may be lost, in the mean of the views held back
  ModelFormat format = ModelFormat::ply;
  TrialWriter write;
  std::optional<PhotoOf> refit;  // fit colours anew to these photos, or to the model's own pictures
};

/// Searches in the order in which the bound is spent: as few bits as the format has a choice of (spz) for a
/// quarter of it; the harmonics that change colours least for another: a lower degree for all, then, where
/// zeros are packed (spz), for as many Gaussians as possible; last the Gaussians without which the pictures
/// change least, for all that remains, half of it at least. What a Gaussian is worth is learned in the
/// training views, the bound is on the mean of those held back, in both sizes where they have two. Every
/// candidate is judged as it reads back from its file, so the bound holds for what is written. The model's
/// axes are those of the format, and it is not Scaffold-GS's. Throws Error for views that a target cannot be
/// measured in (Calibrator).
Trimmed trim(gl::Context& context, const Model& model, const lab::ViewSplit& views,
             const TrimSettings& settings);

}  // namespace binosplat::compact
