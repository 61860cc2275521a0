#pragma once
// What a SplatStream and its renderer share.

#include <binosplat/stream.h>

#include "stream/stream.h"

namespace binosplat {

struct SplatStream::Impl {
  explicit Impl(std::shared_ptr<Stream> opened) : stream(std::move(opened)) {}

  std::shared_ptr<Stream> stream;  // not null
  gl::Context* context = nullptr;  // of its renderer; null: there is none
  int precision = 0;               // its renderer's, PRECISION_
  bool is_drawn = false;           // by a frame that was submitted and is not finished
};

}  // namespace binosplat
