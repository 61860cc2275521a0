#pragma once
// A GPU that waited has a low clock, and times taken then are too long.

#include "base/clock.h"
#include "gl/context.h"

namespace binosplat::lab {

/// Draws for so long, a second or a little less, after which a GPU's clock is up again. A software renderer
/// has none to wait for.
template <typename Draw>
void wake(const gl::Context& context, double ms, const Draw& draw) {
  if (context.software()) return;
  const auto start = Clock::now();
  while (ms_since(start) < ms) draw();
}

}  // namespace binosplat::lab
