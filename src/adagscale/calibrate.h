#pragma once
// Calibrates a model: measures AdaGScale's table by depth, and searches the largest tolerance, AdaGScale's K,
// with which pictures keep a quality (docs/adagscale.md, "Drawing").

#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adagscale/calibration.h"
#include "adagscale/depth_table.h"
#include "base/image.h"
#include "render/frame.h"
#include "scene/camera.h"

namespace binosplat::adagscale {

/// The number of training views in which programs calibrate, and the PSNR for which they find K, dB.
constexpr std::size_t default_views = 16;
constexpr double default_quality = 40.0;

struct CalibrationView {
  Camera camera;               // in world coordinates (scene/axes.h)
  std::optional<Image> photo;  // RGB in the camera's size
  glm::mat4x3 exposure{1.0f};  // applied to pictures before the comparison (exposed() of base/image.h)
};

/// Measures the cost of drawing settings for a model in some views.
class Calibrator {
 public:
  /// Draws the exact pictures, with the order, projection and precision of `exact`. Throws Error without
  /// views, or if the target is a drop and a view has no photo of its size.
  Calibrator(std::shared_ptr<render::GpuModel> model, const std::vector<CalibrationView>& views,
             double near_plane, CalibrationTarget::Kind kind, const render::FrameSettings& exact = {});
  ~Calibrator();

  struct Cost {
    double mean_db = 0.0;   // by the target's kind: the drop against photos, or the PSNR (at most 100)
    double worst_db = 0.0;  // a view without any pair that has some in the exact picture has 0 dB
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

  /// The largest tolerance that holds the target: a drop in the mean of the views, as the paper's tables have
  /// it, a quality in each view, so that no picture is worse than the user asked for. The search begins at
  /// the settings' tolerance; without one, at that of the rule. The settings have a threshold. Calls
  /// `after_picture` after each picture.
  CalibrationEntry find(render::FrameSettings settings, double target_db,
                        const std::function<void()>& after_picture = {});

 private:
  Cost cost(render::Frame& frame, const render::FrameSettings& settings, int drawings,
            const std::function<void(std::size_t)>& after_view = {});

  struct Reference;
  render::Frame frame_;
  CalibrationTarget::Kind kind_;
  std::vector<std::string> names_;
  std::vector<shared::View> views_;
  std::vector<std::unique_ptr<Reference>> references_;
};

/// AdaGScale as the paper has it.
inline const render::FrameSettings whole_method{
    {.threshold = Threshold::adagscale, .transmittance = Transmittance::depth}};

/// The target of a calibration, and the settings of its depth table, whose frame all pictures have.
struct CalibrationSettings {
  CalibrationTarget target = {};
  DepthTableSettings table = {};
  std::vector<render::FrameSettings> rules = {whole_method};  // inexact; the calibration has an entry of each
  std::vector<Camera> reached = {};  // cameras within the calibration's reach; empty: the views'
};

/// The usual number of tolerances that a search tries, each in all views.
constexpr std::size_t search_steps = 7;

/// Measures the depth table, then finds the tolerance of each entry. Calls `done(n)` after the n-th picture.
ThresholdCalibration calibrate(std::shared_ptr<render::GpuModel> model,
                               const std::vector<CalibrationView>& views, double near_plane,
                               const CalibrationSettings& wanted,
                               const std::function<void(std::size_t)>& done = {});

/// Finds K for settings that lack it: for their quality (none: default_quality), with their order,
/// projection, precision and source of transmittance (none: by depth). `reached` and `done` as above.
ThresholdCalibration find_k(std::shared_ptr<render::GpuModel> model,
                            const std::vector<CalibrationView>& views, double near_plane,
                            const render::FrameSettings& requested, std::vector<Camera> reached,
                            const std::function<void(std::size_t)>& done = {});

}  // namespace binosplat::adagscale
