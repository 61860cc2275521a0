#pragma once
// Finds the transmittance bound by depth (AdaGScale, sections 3.2 and 3.4) and the tolerance of each rule and
// source that costs as much as is asked for, on some views of a model. The pictures stay on the GPU: only
// sums are read back.

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

/// Returns what `measure` returns for a step of this name, or returned in an earlier run that was ended.
using Keep = std::function<nlohmann::ordered_json(const std::string& step,
                                                  const std::function<nlohmann::ordered_json()>& measure)>;

struct CalibrationView {
  Camera camera;               // of the world (scene/axes.h)
  std::optional<Image> photo;  // RGB in the camera's size
  glm::mat4x3 exposure{1.0f};  // of pictures, before they are compared with it (exposed() of base/image.h)
};

/// Views of three tasks. A model that was fitted to some views has to be judged in others, or its error would
/// be underestimated.
struct ViewSplit {
  std::vector<Camera> training;            // of the world
  std::vector<CalibrationView> held_back;  // at least one; their mean decides
  std::vector<CalibrationView> test;       // decide nothing: their numbers are only reported; may be empty
  // The same two in the cameras' own size, where that is larger; else empty. A bound holds in both sizes.
  std::vector<CalibrationView> held_back_own, test_own;
  double near_plane = near_default;  // world units
};

/// What a Calibrator takes beside what it compares.
struct CalibratorOptions {
  Keep keep = {};                        // of costs
  std::optional<int> order, projection;  // of the exact pictures; none: the model's
};

/// A model in some views, and what each way to draw it costs there.
class Calibrator {
 public:
  /// Draws the exact pictures. Context and model must outlive it. Throws Error for no views, views of
  /// different photos (some with, some without), or none where the target is a drop.
  Calibrator(gl::Context& context, const Model& model, const std::vector<CalibrationView>& views,
             double near_plane, CalibrationTarget::Kind kind, CalibratorOptions options = {});
  ~Calibrator();

  struct Cost {
    double mean_db = 0.0;  // in the target's terms: drop, or PSNR (at most 100)
    double worst_db = 0.0;
    std::size_t worst_view = 0;
    double pairs_removed = 0.0;   // share of the exact frame's pairs, mean over the views
    std::vector<double> view_db;  // by view
    double pairs = 0.0;           // mean over the views
    double ms = 0.0;              // GPU time of a frame, mean over the views
  };

  /// What settings cost; frames that go by measurements are drawn until those have settled.
  Cost cost(const render::FrameSettings& settings);

  const std::vector<shared::View>& views() const { return views_; }

  /// PSNR of the exact pictures against the photos, mean over the views; 100 without photos.
  double exact_photo_db() const;

  /// What another model in the same axes costs in the place of this one, drawn exactly; of so many drawings
  /// of a view the median time counts. `after_view(views)` is called after each.
  Cost cost(const Model& other, int drawings = 1, const std::function<void(std::size_t)>& after_view = {});

  DepthTable depth_table(const measure::DepthTableSettings& settings = {});

  /// The largest tolerance that costs no more than the target: the mean over the views. The settings' own
  /// tolerance is where the search begins.
  CalibrationEntry find(render::FrameSettings settings, double target_db);

 private:
  Cost cost(render::Frame& frame, const render::FrameSettings& settings, int drawings,
            const std::function<void(std::size_t)>& after_view = {});

  struct Reference;
  gl::Context& context_;
  render::Frame frame_;
  CalibrationTarget::Kind kind_;
  Keep keep_;
  std::vector<std::string> names_;
  std::vector<shared::View> views_;
  std::vector<std::unique_ptr<Reference>> references_;
};

/// What a calibration looks for, and how its table of bounds is measured; all is drawn in the table's order
/// and projection.
struct CalibrationSettings {
  CalibrationTarget target;
  measure::DepthTableSettings table = {};
  std::vector<Rule> rules = all_rules();
  Keep keep = {};
};

/// The ways to draw that a calibration has entries for: of these rules those that are not exact.
std::vector<render::FrameSettings> calibrated_settings(const std::vector<Rule>& rules = all_rules());

/// Measures the table of bounds by depth, then finds every entry, and calls `done(entries, of)` after each.
ThresholdCalibration calibrate(gl::Context& context, const Model& model,
                               const std::vector<CalibrationView>& views, double near_plane,
                               const CalibrationSettings& wanted,
                               const std::function<void(std::size_t, std::size_t)>& done = {});

}  // namespace binosplat::lab
