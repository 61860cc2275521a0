#pragma once
// Keeps 8-bit pictures on the GPU, 4 bytes per pixel, and measures the error of later frames against them,
// without reading exact frames back.

#include <span>
#include <vector>

#include "gl/buffer.h"
#include "gl/dispatch.h"
#include "render/frame.h"

namespace binosplat::lab {

class BytePictures {
 public:
  explicit BytePictures(gl::Context& context);

  static std::int64_t bytes(std::span<const shared::View> views);

  /// Stores in `kept` the pictures, over black, that `frame` has just drawn of `views`.
  void keep(const render::Frame& frame, std::span<const shared::View> views, gl::Buffer& kept);

  /// Returns each view's mean squared error over pixels and channels, between the 8-bit pictures of `frame`
  /// and of `kept`, for colours from 0 to 1. It is exactly 0 if the pictures are equal. `kept` must hold
  /// pictures of the same sizes.
  std::vector<double> errors(const render::Frame& frame, std::span<const shared::View> views,
                             const gl::Buffer& kept);

 private:
  gl::Dispatcher dispatcher_;
  gl::Buffer sums_;  // one uint per workgroup
};

}  // namespace binosplat::lab
