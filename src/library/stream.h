#pragma once
// The state that a SplatStream shares with its renderer.

#include <binosplat/stream.h>

#include "stream/stream.h"

namespace binosplat {

struct SplatStream::Impl {
  explicit Impl(std::shared_ptr<Stream> opened) : stream(std::move(opened)) {}

  std::shared_ptr<Stream> stream;  // not null
  gl::Context* context = nullptr;  // of its renderer; null without one
  int precision = 0;               // its renderer's, PRECISION_
  bool is_drawn = false;           // by a submitted, unfinished frame
};

}  // namespace binosplat
