#pragma once
// Keeps 8-bit pictures on the GPU, one word a pixel, and measures the error of later frames against them. For
// the exact frames of a path, of which none is read back.

#include <span>
#include <vector>

#include "gl/buffer.h"
#include "gl/dispatch.h"
#include "render/frame.h"

namespace binosplat::lab {

class BytePictures {
 public:
  explicit BytePictures(gl::Context& context);

  /// Bytes of the pictures of these views.
  static std::int64_t bytes(std::span<const shared::View> views);

  /// Keeps the pictures, over black, of the last frame, which drew `views`.
  void keep(const render::Frame& frame, std::span<const shared::View> views, gl::Buffer& kept);

  /// The mean squared error of each view over its pixels and channels, between 8-bit pictures; exactly 0 if
  /// equal. `kept` holds views of the same sizes.
  std::vector<double> errors(const render::Frame& frame, std::span<const shared::View> views,
                             const gl::Buffer& kept);

 private:
  gl::Dispatcher dispatcher_;
  gl::Buffer sums_;  // a uint for each work group
};

}  // namespace binosplat::lab
