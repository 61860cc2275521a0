#pragma once
// The views that a measurement draws: single views, or successive frames.

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "adagscale/calibrate.h"
#include "base/image.h"
#include "measure/flip.h"
#include "render/gpu_model.h"
#include "scene/camera.h"
#include "shared/types.h"
#include "stream/level_choice.h"

namespace binosplat::lab {

/// The views of one frame: a single camera, or both eyes.
struct BenchView {
  std::string name;
  std::vector<shared::View> eyes;
  std::optional<Image> photo = {};  // for a single camera only, in its size
  glm::mat4x3 exposure{1.0f};       // applied to pictures before the comparison
};

/// Successive frames. Drawing starts without earlier measurements, as in a program that has just started.
struct Stretch {
  std::vector<std::vector<shared::View>> frames;  // the views of each frame
  std::size_t moving = 0;                         // number of frames before the head stops; only these count
};

/// Returns the first frames of `count` stretches of `length` frames, spread evenly over all `total` frames; a
/// single stretch is in the middle. Returns fewer to avoid overlaps, and only 0 if none fits.
std::vector<std::size_t> stretch_starts(std::size_t total, std::size_t length, std::size_t count);

/// The levels that a model has loaded.
struct LoadedLevels {
  std::size_t gaussians = 0;
  std::optional<double> predicted_db = {};  // PSNR against the finest levels; none: not predicted
};

/// A model whose levels follow the views: `load_levels` loads them. Without `load_levels` they are fixed.
struct FollowingModel {
  std::shared_ptr<render::GpuModel> model;
  std::function<LoadedLevels(std::span<const shared::View> views)> load_levels = {};
};

/// Exactly one of both is set: views or stretches.
struct BenchCase {
  std::vector<BenchView> views;
  std::vector<Stretch> stretches;
  double near_plane = near_default;
  shared::View small = {};  // few pixels, to compare with the float64 reference
  /// `tested` has the cameras of `views` in world coordinates, if each view is a single camera. `training`
  /// has the views in which tolerances and depth tables are found, if the suite requests training views.
  std::vector<adagscale::CalibrationView> tested, training;
  std::function<FollowingModel(const DetailRequest&)> follow;  // only for a scene with levels of detail

  const std::vector<shared::View>& first() const;
};

struct BenchEffort {
  int frames = 30;                               // timed frames per view and repeat
  int repeats = 3;                               // passes over all frames; the spread of times is the noise
  double ppd = measure::flip_pixels_per_degree;  // pixels per degree, for FLIP
  bool perception = true;    // also measures SSIM, FLIP and alphas per pixel; PSNR alone is fast
  bool seen = false;         // measures visible differences for a gaze along each eye's axis
  bool own_shaders = false;  // the context reads a folder of shaders, whose rules the reference does not know
};

}  // namespace binosplat::lab
