#pragma once
// How far drawn pixels are from wanted ones: compared on the GPU, so that a search reads sums back, not
// pictures.

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "base/image.h"
#include "gl/buffer.h"
#include "gl/dispatch.h"

namespace binosplat::render {

class SquaredError {
 public:
  /// `wanted` is what should be drawn, in the order of a frame's views. `levels`: 0 compares values as they
  /// are, 255 as 8 bits would keep them. `exposure` changes what is drawn before it is compared (exposed() of
  /// base/image.h).
  SquaredError(gl::Context& context, std::span<const Picture> wanted, std::uint32_t levels = 0,
               const glm::mat4x3& exposure = glm::mat4x3(1.0f));

  /// Wants nothing yet: add() says what should be drawn.
  explicit SquaredError(gl::Context& context);

  /// Adds to what should be drawn the pixels that a frame has just drawn; they stay on the GPU.
  void add(const gl::Buffer& colours, std::uint32_t pixels);
  /// The same for a window: its first pixel is number `first` of all, its rows are `pitch` pixels apart.
  void add_window(const gl::Buffer& colours, glm::uvec2 size, std::uint32_t first, std::uint32_t pitch);
  /// Nothing should be drawn any more, until more is added.
  void clear() { pixels_ = 0; }

  /// The mean over pixels and channels of all pictures together, over black and clamped to [0, 1]. `colours`
  /// as render::Frame has them.
  double mean(const gl::Buffer& colours);

  /// The same in dB; infinite for equal pictures.
  double psnr(const gl::Buffer& colours);

 private:
  gl::Dispatcher dispatcher_;
  gl::Buffer wanted_;    // vec4 by pixel
  gl::Buffer sums_;      // float by work group
  gl::Buffer exposure_;  // three rows
  std::uint32_t pixels_ = 0;
  std::uint32_t levels_ = 0;
};

}  // namespace binosplat::render
