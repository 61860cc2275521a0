#pragma once
// The words through which work groups pass their counts to later groups of the same dispatch
// (look_back.glsl).

#include <cstdint>
#include <utility>

#include "gl/buffer.h"

namespace binosplat::render {

class LookBack {
 public:
  explicit LookBack(gl::Context& context) : context_(context), words_(context, "look-back counts") {}

  /// Makes room for `groups` groups. No dispatch that uses the buffer may be under way.
  void reserve(std::int64_t groups) {
    const std::int64_t bytes = (4 + 2 * groups) * 4;
    if (words_.bytes() >= bytes) return;
    words_.reserve_zeros(bytes);
    half_ = 0;
  }

  const gl::Buffer& words() const { return words_; }

  /// Returns the uniform look_back_half of the next dispatch, which must have at least one group. If programs
  /// are only prepared, no dispatch clears the other half, so the half stays.
  std::uint32_t next_half() { return context_.is_preparing() ? half_ : std::exchange(half_, 1 - half_); }

 private:
  gl::Context& context_;
  gl::Buffer words_;
  std::uint32_t half_ = 0;
};

}  // namespace binosplat::render
