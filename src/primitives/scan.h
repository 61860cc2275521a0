#pragma once
// Exclusive prefix sum on the GPU: reduce, then scan, in two dispatches; sums stop at COUNT_MAX instead of
// wrapping.

#include "gl/dispatch.h"

namespace binosplat::primitives {

class Scan {
 public:
  explicit Scan(gl::Context& context)
      : block_sums_(context, "sums of the scan's blocks"), total_(context, "total") {}

  /// Room for `count` values; no dispatch may be under way that uses this scan.
  void reserve(std::int64_t count);

  /// Replaces each of the first arguments[which].count values (uint) by the sum of those before it; the sum
  /// of all is left in total(). Up to three values after them change, too. `arguments` holds
  /// DispatchArguments.
  void run(gl::Dispatcher& dispatcher, const gl::Buffer& arguments, std::uint32_t which,
           const gl::Buffer& values);

  const gl::Buffer& total() const { return total_; }

 private:
  gl::Buffer block_sums_;
  gl::Buffer total_;
};

}  // namespace binosplat::primitives
