#pragma once
// The exact frames of a path: their pair counts, and their pictures, kept on the GPU to compare other frames
// with.

#include <memory>
#include <vector>

#include "lab/byte_pictures.h"
#include "lab/motion_paths.h"
#include "render/frame.h"

namespace binosplat::lab {

class ExactFrames {
 public:
  /// Pictures stay on the GPU up to `bytes_max`; the rest is drawn again, by a Frame of its own, whenever it
  /// is asked for.
  ExactFrames(std::shared_ptr<render::GpuModel> model, std::int64_t bytes_max);

  /// Draws the frames of a path with `frame`, each pose once; those of the last path are gone.
  void draw(render::Frame& frame, const MotionPath& path);

  double pairs(std::size_t segment, std::size_t n) const { return pose(segment, n).pairs; }
  /// How many poses of the path are not kept.
  std::size_t left_out() const;

  /// The PSNR of each view that `drawn` drew of a segment's frame `n`, in dB; infinite for equal pictures.
  std::vector<double> psnr(const render::Frame& drawn, std::size_t segment, std::size_t n);

 private:
  struct Pose {
    std::vector<shared::View> views;
    double pairs = 0.0;
    gl::Buffer* pictures = nullptr;  // none: not kept
  };
  const Pose& pose(std::size_t segment, std::size_t n) const { return poses_[segments_.at(segment).at(n)]; }
  gl::Buffer* room_for(const std::vector<shared::View>& views);

  std::shared_ptr<render::GpuModel> model_;
  std::int64_t bytes_max_;
  BytePictures bytes_;
  std::vector<std::vector<std::size_t>> segments_;  // the pose of each frame
  std::vector<Pose> poses_;
  std::vector<std::unique_ptr<gl::Buffer>> buffers_;  // of all paths so far
  std::size_t taken_ = 0;                             // of these, by this path
  std::unique_ptr<render::Frame> again_;
  std::unique_ptr<gl::Buffer> again_pictures_;
};

}  // namespace binosplat::lab
