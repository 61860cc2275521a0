#pragma once
// Uploads to places here and there of a buffer.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "gl/buffer.h"
#include "gl/dispatch.h"
#include "gl/fence.h"

namespace binosplat::render {

/// Records go to the GPU side by side, from where a shader moves each to its place: an upload to each place
/// takes a driver 10 us, whatever its size.
class Scatter {
 public:
  /// The most records that lie on the GPU at once, side by side; fewer where the buffer has fewer. Larger
  /// uploads go in turns, each of which waits for the one before.
  static constexpr std::size_t records_at_once = 1 << 18;

  explicit Scatter(gl::Context& context);

  /// Fills records of `words` of 4 bytes of the buffer, which fill(places, room) makes, some at a time: all
  /// words of each, since what lies in the room is of no meaning.
  void upload(
      const gl::Buffer& buffer, std::span<const std::uint32_t> places, std::size_t words,
      const std::function<void(std::span<const std::uint32_t> places, std::span<std::uint32_t> room)>& fill);

 private:
  gl::Dispatcher dispatcher_;
  gl::Buffer places_;   // uint by record
  gl::Buffer records_;  // uint by record and word
  gl::Fence read_;      // by the GPU
};

}  // namespace binosplat::render
