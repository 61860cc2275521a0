#pragma once
// The objects of a measurement: views, successive frames, or a turning head.

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/image.h"
#include "lab/calibrate.h"
#include "lab/floors.h"
#include "measure/flip.h"
#include "render/gpu_model.h"
#include "scene/camera.h"
#include "shared/types.h"
#include "stream/choice.h"

namespace binosplat::lab {

/// One frame: a single camera, or both eyes.
struct BenchView {
  std::string name;
  std::vector<shared::View> eyes;
  std::optional<Image> photo = {};  // of the only eye, in its size
  glm::mat4x3 exposure{1.0f};       // applied to pictures before the comparison
};

/// Successive frames. Drawing starts without earlier measurements, as in a program that has just started.
struct Stretch {
  std::vector<std::vector<shared::View>> frames;  // the views of each frame
  std::size_t moving = 0;                         // number of frames that count; then the head stands still
};

/// The first frames of `count` stretches of `length` frames, spread evenly over `total`, both ends included.
/// Fewer if they would overlap; one at 0 if none fits.
std::vector<std::size_t> stretch_starts(std::size_t total, std::size_t length, std::size_t count);

/// The levels that a model was brought to.
struct LoadedLevels {
  std::size_t gaussians = 0;
  std::optional<double> predicted_db = {};  // PSNR against the finest; none: not predicted
};

/// A model whose levels follow the views; without `load_levels` its levels are fixed.
struct FollowingModel {
  std::shared_ptr<render::GpuModel> model;
  std::function<LoadedLevels(std::span<const shared::View> views)> load_levels = {};  // reads needed levels
};

/// Exactly one of the three is set: views, stretches or turned.
struct BenchCase {
  std::vector<BenchView> views;
  std::vector<Stretch> stretches;
  std::optional<Camera> turned;  // in the model's axes
  double near_plane = near_default;
  shared::View small = {};  // few pixels, to compare with the float64 reference
  /// The views in the world, and training views for tolerances and tables by depth, if requested.
  std::vector<CalibrationView> tested, training;
  std::function<FollowingModel(const DetailRequest&)> follow;  // only for a scene with levels of detail

  /// The views of the first frame.
  const std::vector<shared::View>& first() const;
};

struct BenchEffort {
  int frames = 30;                               // timed, per view and repeat
  int repeats = 3;                               // passes over everything; their spread is the noise
  double ppd = measure::flip_pixels_per_degree;  // for FLIP
  std::optional<Peaks> peaks = {};               // of the GPU; adds floors to whole pictures
  bool perception = true;  // SSIM, FLIP and blended pixels; else only PSNR, which is fast
  bool seen = false;       // visibility of errors for a gaze along each axis
  bool popping = false;    // measures popping in the first stretch
};

/// `count` indices spread evenly over `all`, both ends included; all if there are no more.
std::vector<std::size_t> spread_evenly(std::size_t all, std::size_t count);

}  // namespace binosplat::lab
