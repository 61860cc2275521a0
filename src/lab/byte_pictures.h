#pragma once
// Pictures kept on the GPU as 8 bits show them, and how far each view of another frame is from them: of a
// path's exact frames a word a pixel stays, and no picture is read back.

#include <span>
#include <vector>

#include "gl/buffer.h"
#include "gl/dispatch.h"
#include "render/frame.h"

namespace binosplat::lab {

class BytePictures {
 public:
  explicit BytePictures(gl::Context& context);

  /// Bytes that the pictures of these views take.
  static std::int64_t bytes(std::span<const shared::View> views);

  /// Keeps the pictures of the last frame drawn, which was of `views`, over black.
  void keep(const render::Frame& frame, std::span<const shared::View> views, gl::Buffer& kept);

  /// The mean squared error of each of the views over its own pixels and channels, both as 8 bits keep them;
  /// 0 exactly where they are equal. `kept` is of views of the same sizes.
  std::vector<double> errors(const render::Frame& frame, std::span<const shared::View> views,
                             const gl::Buffer& kept);

 private:
  gl::Dispatcher dispatcher_;
  gl::Buffer sums_;  // uint by work group
};

}  // namespace binosplat::lab
