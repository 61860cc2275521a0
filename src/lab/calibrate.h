#pragma once
// Finds the transmittance bound by depth (AdaGScale, sections 3.2 and 3.4). Also finds, for each rule and
// source, the tolerance that reaches a target in some views of a model. Pictures stay on the GPU; only sums
// are read back.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/image.h"
#include "lab/rule.h"
#include "lab/settings.h"
#include "measure/depth_table.h"
#include "render/frame.h"
#include "scene/camera.h"
#include "scene/threshold_calibration.h"

namespace binosplat::lab {

/// Returns the result of `measure` for a step of this name, or that of an interrupted earlier run.
using StepCache = std::function<nlohmann::ordered_json(
    const std::string& step, const std::function<nlohmann::ordered_json()>& measure)>;

struct CalibrationView {
  Camera camera;               // in the world (scene/axes.h)
  std::optional<Image> photo;  // RGB in the camera's size
  glm::mat4x3 exposure{1.0f};  // applied to pictures before the comparison (exposed() of base/image.h)
};

/// Training, held-back and test views. Views that a model was fitted to underestimate its error, so others
/// validate it.
struct ViewSplit {
  std::vector<Camera> training;            // in the world
  std::vector<CalibrationView> held_back;  // at least one; their mean decides
  std::vector<CalibrationView> test;       // only reported, decide nothing; may be empty
  // The same two in the cameras' own size if that is larger, else empty. A bound must hold in both sizes.
  std::vector<CalibrationView> held_back_own, test_own;
  double near_plane = near_default;  // world units
};

/// Options of a Calibrator.
struct CalibratorOptions {
  StepCache cache = {};                  // for costs
  std::optional<int> order, projection;  // of the exact pictures; none: the model's
};

/// Measures the cost of drawing settings for a model in some views.
class Calibrator {
 public:
  /// Draws the exact pictures. Context and model must outlive it. Throws Error without views, if only some
  /// have photos, or if the target is a drop and they have none.
  Calibrator(gl::Context& context, const Model& model, const std::vector<CalibrationView>& views,
             double near_plane, CalibrationTarget::Kind kind, CalibratorOptions options = {});
  ~Calibrator();

  struct Cost {
    double mean_db = 0.0;  // in the target's unit: drop, or PSNR (at most 100)
    double worst_db = 0.0;
    std::size_t worst_view = 0;
    double pairs_removed = 0.0;   // share of the exact frame's pairs, mean over the views
    std::vector<double> view_db;  // for each view
    double pairs = 0.0;           // mean over the views
    double ms = 0.0;              // GPU time of a frame, mean over the views
  };

  /// The cost of settings. With measured transmittance, draws until the measurements have settled.
  Cost cost(const render::FrameSettings& settings);

  const std::vector<shared::View>& views() const { return views_; }

  /// PSNR of the exact pictures against the photos, mean over the views; 100 without photos.
  double exact_photo_db() const;

  /// The cost of another model in the same axes, drawn exactly. `ms` is the median of `drawings` frames a
  /// view. Calls `after_view(views)` after each view.
  Cost cost(const Model& other, int drawings = 1, const std::function<void(std::size_t)>& after_view = {});

  DepthTable depth_table(const measure::DepthTableSettings& settings = {});

  /// The largest tolerance whose mean cost over the views is within the target. The search begins at the
  /// settings' tolerance.
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

/// The target of a calibration, and the settings of its table. Everything is drawn in the table's order and
/// projection.
struct CalibrationSettings {
  CalibrationTarget target;
  measure::DepthTableSettings table = {};
  std::vector<Rule> rules = all_rules();
  StepCache cache = {};
};

/// The settings that a calibration has entries for: the inexact ones of these rules.
std::vector<render::FrameSettings> calibrated_settings(const std::vector<Rule>& rules = all_rules());

/// Measures the table of bounds by depth, then finds every entry, and calls `done(entries, of)` after each.
ThresholdCalibration calibrate(gl::Context& context, const Model& model,
                               const std::vector<CalibrationView>& views, double near_plane,
                               const CalibrationSettings& wanted,
                               const std::function<void(std::size_t, std::size_t)>& done = {});

}  // namespace binosplat::lab
