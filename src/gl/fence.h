#pragma once
// Waiting for the GPU.

#include "gl/context.h"

namespace binosplat::gl {

/// A mark among the commands that the GPU gets.
class Fence {
 public:
  explicit Fence(Context& context) : context_(context) {}
  ~Fence() { remove(); }
  Fence(const Fence&) = delete;
  Fence& operator=(const Fence&) = delete;

  /// Marks the commands given so far, instead of those marked before.
  void set();
  /// Waits until the GPU has run the commands marked, if any. Throws std::runtime_error if it is lost.
  void wait();
  /// Whether it would not have to wait.
  bool is_done();

 private:
  void remove();

  Context& context_;
  GLsync sync_ = nullptr;
};

}  // namespace binosplat::gl
