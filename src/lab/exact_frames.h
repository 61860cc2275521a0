#pragma once
// The exact frames of some stretches: their pair counts, and their pictures on the GPU for comparisons.

#include <memory>
#include <vector>

#include "lab/bench_views.h"
#include "lab/byte_pictures.h"
#include "render/frame.h"

namespace binosplat::lab {

class ExactFrames {
 public:
  /// Draws all frames in the order and projection of `settings`, but successive frames with equal views only
  /// once. Keeps up to `bytes_max` of pictures on the GPU; draws the others again on demand.
  ExactFrames(std::shared_ptr<render::GpuModel> model, const render::FrameSettings& settings,
              std::span<const Stretch> stretches, std::int64_t bytes_max);

  double pairs(std::size_t stretch, std::size_t n) const { return pose(stretch, n).pairs; }

  /// Returns the PSNR in dB of each view that `drawn` has just drawn, against frame `n` of the stretch. Both
  /// pictures are rounded to 8 bits. The PSNR is infinite if they are equal.
  std::vector<double> psnr(const render::Frame& drawn, std::size_t stretch, std::size_t n);

 private:
  struct Pose {
    std::vector<shared::View> views;
    double pairs = 0.0;
    std::unique_ptr<gl::Buffer> pictures;  // null if they are not kept
  };
  const Pose& pose(std::size_t stretch, std::size_t n) const { return poses_[poses_of_.at(stretch).at(n)]; }

  render::FrameSettings settings_;
  render::Frame frame_;
  BytePictures bytes_;
  gl::Buffer again_;                                // for pictures that are not kept
  std::vector<std::vector<std::size_t>> poses_of_;  // by stretch and frame: its index in poses_
  std::vector<Pose> poses_;
};

}  // namespace binosplat::lab
