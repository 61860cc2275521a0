#pragma once
// Encodes rows of one size on all cores, and passes them on in blocks.

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "base/progress.h"

namespace binosplat {

class RowWriter {
 public:
  using Sink = std::function<void(std::span<const std::byte>)>;

  /// `all`, for the progress, is the number of rows of all calls of write() together.
  RowWriter(Sink sink, std::uint64_t all) : sink_(std::move(sink)), progress_("writing", all) {}

  /// Writes `count` rows of `bytes` bytes each; encode(i, row) fills row i, which starts as zeros.
  template <typename Encode>
  void write(std::size_t count, std::size_t bytes, const Encode& encode) {
    constexpr std::size_t most = 65536;
    for (std::size_t begin = 0; begin < count; begin += most) {
      const std::size_t rows = std::min(most, count - begin);
      block_.assign(rows * bytes, std::byte{0});
      parallel_for(
          rows, [&](std::size_t k) { encode(begin + k, block_.data() + k * bytes); }, 1024);
      sink_(block_);
      progress_.update(done_ += rows);
    }
  }

 private:
  Sink sink_;
  Progress progress_;
  std::uint64_t done_ = 0;
  std::vector<std::byte> block_;
};

}  // namespace binosplat
