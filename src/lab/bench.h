#pragma once
// One point of the chart: a way to draw, first verified, then timed, then compared with the exact picture and
// with the photos.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/image.h"
#include "gl/context.h"
#include "lab/bench_results.h"
#include "lab/settings.h"
#include "measure/flip.h"
#include "render/gpu_model.h"
#include "scene/model.h"
#include "shared/types.h"

namespace binosplat::lab {

/// What one frame draws: a camera by itself, or both eyes.
struct BenchView {
  std::string name;
  std::vector<shared::View> eyes;
  std::optional<Image> photo;  // of the only eye, in its size
  glm::mat4x3 exposure{1.0f};  // of pictures, before they are compared with it
};

struct BenchEffort {
  int frames = 30;                               // timed, a view and repeat
  int repeats = 3;                               // each a pass over all views; their spread is the noise
  double ppd = measure::flip_pixels_per_degree;  // for FLIP
  std::optional<Peaks> peaks;                    // of the GPU: whole pictures get a profile
  bool seen = false;                             // what eyes see that look along their axes
  std::optional<float> far = {};                 // where the table by depth ends, world units; none: fits
};

/// The points that share a model, its views and their size. What is exact is drawn once, at first use.
class Bench {
 public:
  /// `small` is a view of few pixels, in which the GPU is compared with the float64 reference. The context
  /// and the model must outlive the bench.
  Bench(gl::Context& context, const Model& model, std::vector<BenchView> views, const shared::View& small,
        const BenchEffort& effort);

  /// About how long so many points will take that are like this one, in ms. Draws two frames.
  double work_ms(const BenchSettings& settings, std::size_t points);

  /// A point that fails verification is not timed: it has a problem instead. TRANSMITTANCE_DEPTH goes by a
  /// table of the bench's own views. Throws Error where the GPU cannot draw the views at all.
  BenchNumbers measure(BenchSettings settings);

 private:
  /// A view's exact pictures by eye, over black; and what they are worth against the photo.
  struct Exact {
    std::vector<Image> eyes;
    std::vector<Picture> pictures;     // of two eyes, for their disagreement
    std::optional<double> photo_psnr;  // dB, 8 bits
  };

  const std::vector<Exact>& exact();
  const DepthTable& depth_table();
  std::string verify(const BenchSettings& settings);
  void time(const BenchSettings& settings, BenchNumbers& point);
  void judge(const BenchSettings& settings, BenchNumbers& point);
  ViewNumbers compare(const BenchView& view, const Exact& exact, const std::vector<Picture>& drawn) const;

  const Model& model_;
  std::shared_ptr<render::GpuModel> gpu_model_;
  std::vector<BenchView> views_;
  shared::View small_;
  BenchEffort effort_;
  std::vector<Exact> exact_;
  DepthTable depth_table_;  // of the views, at first use
};

/// `count` of `all` things, spread evenly, first and last among them; all where there are no more.
std::vector<std::size_t> spread_evenly(std::size_t all, std::size_t count);

}  // namespace binosplat::lab
