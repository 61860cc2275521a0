#pragma once
// The conditions under which two pictures can be compared.

#include "base/error.h"
#include "base/image.h"

namespace binosplat::measure {

/// Throws Error unless both pictures have the same size and number of channels, and at least one pixel.
inline void require_comparable(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height) {
    fail("pictures of {} x {} and {} x {} px cannot be compared: expected equal sizes", a.width, a.height,
         b.width, b.height);
  }
  if (a.channels != b.channels) {
    fail("pictures of {} and {} channels cannot be compared: expected equal channels (4 are RGB and alpha)",
         a.channels, b.channels);
  }
  if (a.data.empty()) fail("a picture without pixels cannot be compared");
}

}  // namespace binosplat::measure
