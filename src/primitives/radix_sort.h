#pragma once
// Stable radix sort of (key, value) pairs on the GPU, least significant digit first, 8 or 9 bits a pass.

#include <string>
#include <utility>

#include "gl/dispatch.h"
#include "primitives/scan.h"

namespace binosplat::primitives {

/// Keys and values of 32 bits with a second copy of each, between which the passes of a sort go to and fro.
class PairBuffers {
 public:
  PairBuffers(gl::Context& context, const std::string& label);
  void reserve(std::int64_t count);
  std::int64_t capacity() const { return keys_.bytes() / 4; }

  /// Pairs that a work group of a sort by `bits` bits has: fewer where there is room for few, or where its
  /// counters of 8 bits take less shared memory than more pairs would. Who fills SortAmounts for them needs
  /// it, programs as the define SORT_BLOCK.
  std::uint32_t block(std::uint32_t bits) const;
  gl::Defines block_define(std::uint32_t bits) const { return {{"SORT_BLOCK", std::to_string(block(bits))}}; }

  /// Where the pairs are now.
  gl::Buffer& keys() { return flipped_ ? keys_other_ : keys_; }
  gl::Buffer& values() { return flipped_ ? values_other_ : values_; }
  /// Where the next pass puts them.
  gl::Buffer& keys_out() { return flipped_ ? keys_ : keys_other_; }
  gl::Buffer& values_out() { return flipped_ ? values_ : values_other_; }
  void flip() { flipped_ = !flipped_; }

 private:
  gl::Buffer keys_, keys_other_, values_, values_other_;
  bool flipped_ = false;
};

class RadixSort {
 public:
  explicit RadixSort(gl::Context& context)
      : histogram_(context, "counters of the radix sort"), scan_(context) {}

  /// Room to sort as many pairs as they have room for.
  void reserve(const PairBuffers& pairs);

  /// Bits that each pass of a sort by `bits` bits takes: 8, or 9 where that makes a pass less; and the
  /// passes.
  static std::uint32_t digit_bits(std::uint32_t bits);
  static std::uint32_t passes(std::uint32_t bits);

  /// Sorts the first amounts[0].count pairs by the low `bits` bits of their keys, in whole digits; equal keys
  /// keep their order. `amounts` holds SortAmounts for such digits. Afterwards pairs.keys() and
  /// pairs.values() are the sorted ones.
  void run(gl::Dispatcher& dispatcher, const gl::Buffer& amounts, PairBuffers& pairs, std::uint32_t bits);

 private:
  gl::Buffer histogram_;
  Scan scan_;
};

}  // namespace binosplat::primitives
