#pragma once
// Measures the transmittance bound at each depth (AdaGScale, sections 3.2 and 3.4). Also finds, for each rule
// and source of transmittance, the tolerance that reaches a target in some views. Reads back only sums.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/image.h"
#include "lab/bench_settings.h"
#include "lab/threshold_variant.h"
#include "measure/depth_table.h"
#include "render/frame.h"
#include "scene/camera.h"
#include "scene/threshold_calibration.h"

namespace binosplat::lab {

/// Returns the stored result of the step named `step` of an interrupted run, or else that of `measure`.
using StepCache = std::function<nlohmann::ordered_json(
    const std::string& step, const std::function<nlohmann::ordered_json()>& measure)>;

struct CalibrationView {
  Camera camera;               // in world coordinates (scene/axes.h)
  std::optional<Image> photo;  // RGB in the camera's size
  glm::mat4x3 exposure{1.0f};  // applied to pictures before the comparison (exposed() of base/image.h)
};

/// Views of `trim` and `refit`. The model is fitted to the training views, which therefore underestimate its
/// error, so the validation views validate it.
struct ViewSplit {
  std::vector<Camera> training;             // in world coordinates
  std::vector<CalibrationView> validation;  // at least one; their mean loss must stay within the bound
  std::vector<CalibrationView> test;        // their loss is only reported; may be empty
  // validation and test in the cameras' own size if larger, else empty. The bound must hold in both sizes.
  std::vector<CalibrationView> validation_own, test_own;
  double near_plane = near_default;  // world units
};

struct CalibratorOptions {
  StepCache cache = {};  // stores each result of cost(settings)
  // Of the exact pictures; none: the model's.
  std::optional<Order> order = {};
  std::optional<Projection> projection = {};
};

/// Measures the cost of drawing settings for a model in some views.
class Calibrator {
 public:
  /// Draws the exact pictures. Context and model must outlive this object. Throws Error without views, or if
  /// the target is a drop and a view has no photo of its size.
  Calibrator(gl::Context& context, const Model& model, const std::vector<CalibrationView>& views,
             double near_plane, CalibrationTarget::Kind kind, CalibratorOptions options = {});
  ~Calibrator();

  struct Cost {
    double mean_db = 0.0;  // by the target's kind: the drop against photos, or the PSNR (at most 100)
    double worst_db = 0.0;
    std::size_t worst_view = 0;
    double pairs_removed = 0.0;   // share of the exact frame's pairs, mean over the views
    std::vector<double> view_db;  // of each view, as mean_db
    double pairs = 0.0;           // mean over the views
    double ms = 0.0;              // GPU time of a frame, mean over the views
  };

  /// The cost of settings. With measured transmittance, draws until the measurements have settled.
  Cost cost(const render::FrameSettings& settings);

  const std::vector<shared::View>& views() const { return views_; }
  render::Frame& frame() { return frame_; }

  /// PSNR of the exact pictures against the photos, mean over the views; 100 without photos.
  double exact_photo_db() const;

  /// The cost of another model in the same axes, drawn exactly. Each view is drawn `drawings` times, and its
  /// median time counts. Calls `after_view(n)` after the n-th view, counted from 1.
  Cost cost(const Model& other, int drawings = 1, const std::function<void(std::size_t)>& after_view = {});

  /// The largest tolerance whose mean cost over the views is within the target. The search begins at the
  /// settings' tolerance. The settings have a threshold.
  CalibrationEntry find(render::FrameSettings settings, double target_db);

 private:
  Cost cost(render::Frame& frame, const render::FrameSettings& settings, int drawings,
            const std::function<void(std::size_t)>& after_view = {});

  struct Reference;
  gl::Context& context_;
  render::Frame frame_;
  CalibrationTarget::Kind kind_;
  StepCache cache_;
  std::vector<std::string> names_;
  std::vector<shared::View> views_;
  std::vector<std::unique_ptr<Reference>> references_;
};

/// The target of a calibration, and the settings of its depth table. All pictures have the table's order and
/// projection.
struct CalibrationSettings {
  CalibrationTarget target;
  measure::DepthTableSettings table = {};
  std::vector<ThresholdVariant> rules = all_threshold_settings();
  StepCache cache = {};
};

/// Returns the settings of the inexact rules among `rules`: a calibration has one entry for each.
std::vector<render::FrameSettings> calibrated_settings(
    const std::vector<ThresholdVariant>& rules = all_threshold_settings());

/// Measures the depth table, then finds the tolerance of each entry. Calls `done(n, entries)` after the n-th
/// of all entries.
ThresholdCalibration calibrate(gl::Context& context, const Model& model,
                               const std::vector<CalibrationView>& views, double near_plane,
                               const CalibrationSettings& wanted,
                               const std::function<void(std::size_t, std::size_t)>& done = {});

}  // namespace binosplat::lab
