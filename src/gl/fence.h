#pragma once
// Waits for the GPU.

#include "gl/context.h"

namespace binosplat::gl {

class Fence {
 public:
  explicit Fence(Context& context) : context_(context) {}
  ~Fence() { remove(); }
  Fence(const Fence&) = delete;
  Fence& operator=(const Fence&) = delete;

  /// Marks all commands so far. Replaces the previous mark.
  void set();
  /// Waits until the GPU has run the marked commands, if any. Throws std::runtime_error if the wait fails.
  void wait();
  /// Whether wait() would return at once.
  bool is_done();

 private:
  void remove();

  Context& context_;
  GLsync sync_ = nullptr;
};

}  // namespace binosplat::gl
