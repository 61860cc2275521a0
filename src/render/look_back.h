#pragma once
// What work groups leave for those after them in the one dispatch in which they count
// (look_back.glsl).

#include <cstdint>
#include <utility>

#include "gl/buffer.h"

namespace binosplat::render {

class LookBack {
 public:
  explicit LookBack(gl::Context& context) : words_(context, "counts that are looked back at") {}

  /// Makes room for `groups` groups; no dispatch may be under way that uses it.
  void reserve(std::int64_t groups) {
    const std::int64_t bytes = (4 + 2 * groups) * 4;
    if (words_.bytes() >= bytes) return;
    words_.reserve_zeros(bytes);
    half_ = 0;
  }

  const gl::Buffer& words() const { return words_; }

  /// The uniform look_back_half of the next dispatch, which must have a group at least.
  std::uint32_t next_half() { return std::exchange(half_, 1 - half_); }

 private:
  gl::Buffer words_;
  std::uint32_t half_ = 0;
};

}  // namespace binosplat::render
