#pragma once
// Uploads records to scattered places of a buffer.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "gl/buffer.h"
#include "gl/dispatch.h"
#include "gl/fence.h"

namespace binosplat::render {

/// Uploads the records contiguously; a shader then moves each record to its place. A driver takes 10 us for
/// an upload of any size, so one upload per place would be slow.
class ScatteredUpload {
 public:
  /// Maximum number of records in one upload. A larger upload is split, and each part waits until the GPU has
  /// read the part before.
  static constexpr std::size_t records_at_once = 1 << 18;

  explicit ScatteredUpload(gl::Context& context);

  /// Writes records of `words` words of 4 bytes into the buffer. fill(places, records) packs the records for
  /// some of the places. It must write all words of each record, because `records` is uninitialised.
  void upload(const gl::Buffer& buffer, std::span<const std::uint32_t> places, std::size_t words,
              const std::function<void(std::span<const std::uint32_t> places,
                                       std::span<std::uint32_t> records)>& fill);

 private:
  gl::Dispatcher dispatcher_;
  gl::Buffer places_;   // uint by record
  gl::Buffer records_;  // uint by record and word
  gl::Fence read_;      // signals that the GPU has read places_ and records_
};

}  // namespace binosplat::render
