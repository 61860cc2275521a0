#pragma once
// What settings are measured on: views, frames that follow one another, or a head that turns.

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

/// What one frame draws: a camera by itself, or both eyes.
struct BenchView {
  std::string name;
  std::vector<shared::View> eyes;
  std::optional<Image> photo = {};  // of the only eye, in its size
  glm::mat4x3 exposure{1.0f};       // of pictures, before they are compared with it
};

/// Frames that follow one another, drawn as by a program that has just started.
struct Stretch {
  std::vector<std::vector<shared::View>> frames;  // the views of each
  std::size_t moving = 0;                         // the first so many count; then the head stands still
};

/// Where `count` stretches of `length` frames begin that are spread evenly over `total` frames, first and
/// last included: fewer where so many would overlap, one at 0 where not even one fits.
std::vector<std::size_t> stretch_starts(std::size_t total, std::size_t length, std::size_t count);

/// What a model was brought to.
struct LevelsBrought {
  std::size_t gaussians = 0;
  std::optional<double> predicted_db = {};  // PSNR against the finest; none where nothing is predicted
};

/// A model whose levels of detail follow what is drawn; without `bring` one that stays as it is.
struct FollowingModel {
  std::shared_ptr<render::GpuModel> model;
  std::function<LevelsBrought(std::span<const shared::View> views)> bring = {};  // to what these need
};

/// One of the three is there: views, stretches or the camera that turns.
struct BenchCase {
  std::vector<BenchView> views;
  std::vector<Stretch> stretches;
  std::optional<Camera> turned;  // in the model's axes
  double near_plane = near_default;
  shared::View small = {};  // of few pixels: the GPU is compared with the float64 reference there
  /// The same views in the world, and others to find tolerances and tables by depth in; where that is asked.
  std::vector<CalibrationView> tested, training;
  std::function<FollowingModel(const DetailRequest&)> follow;  // of a scene with levels of detail

  /// What is drawn first.
  const std::vector<shared::View>& first() const;
};

struct BenchEffort {
  int frames = 30;                               // timed, a view and repeat
  int repeats = 3;                               // each a pass over all; their spread is the noise
  double ppd = measure::flip_pixels_per_degree;  // for FLIP
  std::optional<Peaks> peaks = {};               // of the GPU: whole pictures get floors
  bool perception = true;                        // SSIM, FLIP and what pixels blend; else PSNR alone, quickly
  bool seen = false;                             // what eyes see that look along their axes
  bool popping = false;                          // of the first frames of the first stretch
};

/// `count` of `all` things, spread evenly, first and last among them; all where there are no more.
std::vector<std::size_t> spread_evenly(std::size_t all, std::size_t count);

}  // namespace binosplat::lab
