#pragma once
// The OpenGL context that a test program's tests share.

#include <memory>

#include "gl/context.h"

namespace binosplat::test {

/// What --backend auto would take, opened once: a GPU where there is one, else llvmpipe.
inline gl::Context& gl_context() {
  static const std::unique_ptr<gl::Context> context = gl::Context::open();
  return *context;
}

}  // namespace binosplat::test
