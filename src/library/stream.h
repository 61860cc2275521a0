#pragma once
// What a SplatStream and its renderer share.

#include <binosplat/stream.h>

#include "stream/stream.h"

namespace binosplat {

struct SplatStream::Impl {
  explicit Impl(const std::filesystem::path& path, StreamSettings settings)
      : stream(path, std::move(settings)) {}

  Stream stream;
  gl::Context* context = nullptr;  // of its renderer; null: there is none
  int precision = 0;               // its renderer's, PRECISION_
  bool is_drawn = false;           // by a frame that was submitted and is not finished
};

}  // namespace binosplat
