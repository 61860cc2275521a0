#pragma once
// The OpenGL context that all tests of a program share.

#include <memory>

#include "gl/context.h"

namespace binosplat::test {

/// Opens the context that --backend auto would choose, once: a GPU if there is one, else llvmpipe.
inline gl::Context& gl_context() {
  static const std::unique_ptr<gl::Context> context = gl::Context::open();
  return *context;
}

}  // namespace binosplat::test
