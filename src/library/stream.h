#pragma once
// The state that a SplatStream shares with its renderer.

#include <binosplat/stream.h>

#include "stream/stream.h"

namespace binosplat {

struct SplatStream::Impl {
  explicit Impl(std::shared_ptr<Stream> opened) : stream(std::move(opened)) {}

  std::shared_ptr<Stream> stream;  // not null
  gl::Context* context = nullptr;  // the renderer's context; null without a renderer
  int precision = 0;               // the renderer's PRECISION_
  bool is_drawn = false;           // a submitted, unfinished frame draws the stream
};

}  // namespace binosplat
