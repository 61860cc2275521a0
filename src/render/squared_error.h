#pragma once
// The squared error between drawn and wanted pictures. The GPU compares them, so that a search reads back
// sums instead of pictures.

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "base/image.h"
#include "gl/buffer.h"
#include "gl/dispatch.h"

namespace binosplat::render {

class SquaredError {
 public:
  /// `wanted` has the pictures in the order of a frame's views. `levels`: 0 compares the values themselves,
  /// 255 their 8-bit roundings. `exposure` transforms the drawn colours before the comparison (exposed() of
  /// base/image.h).
  SquaredError(gl::Context& context, std::span<const Picture> wanted, std::uint32_t levels = 0,
               const glm::mat4x3& exposure = glm::mat4x3(1.0f));

  /// Starts without wanted pictures; add() appends them.
  explicit SquaredError(gl::Context& context);

  /// Appends the pixels that a frame has just drawn to the wanted pixels, which stay on the GPU.
  void add(const gl::Buffer& colours, std::uint32_t pixels);
  void clear() { pixels_ = 0; }

  /// The mean squared error over pixels and channels of all pictures, over black and clamped to [0, 1].
  /// `colours` is stored as Frame::colours() is.
  double mean(const gl::Buffer& colours);

  /// The PSNR in dB; infinite for equal pictures.
  double psnr(const gl::Buffer& colours);

 private:
  gl::Dispatcher dispatcher_;
  gl::Buffer wanted_;    // vec4 by pixel
  gl::Buffer sums_;      // float by work group
  gl::Buffer exposure_;  // the matrix, as three rows
  std::uint32_t pixels_ = 0;
  std::uint32_t levels_ = 0;
};

}  // namespace binosplat::render
