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

  /// RadixSort::block(capacity()); programs have it as SORT_BLOCK.
  std::uint32_t block() const;
  gl::Number block_number() const { return {"SORT_BLOCK", block(), 4096}; }

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
      : histogram_(context, "counters of the radix sort"),
        digits_(context, "digits of the radix sort"),
        scan_(context) {}

  /// Makes room to sort as many pairs as `pairs` has room for, by `bits` bits.
  void reserve(const PairBuffers& pairs, std::uint32_t bits);

  /// The pairs of a work group where there is room for `capacity` pairs: fewer where that is for few. To fill
  /// SortArguments with.
  static std::uint32_t block(std::int64_t capacity);

  /// The counters (uint) that a sort of `capacity` pairs by `bits` bits takes besides.
  static std::int64_t counters_of(std::int64_t capacity, std::uint32_t bits);

  /// The bits that each pass of a sort by `bits` bits takes: 8, or 9 where that saves a pass; and how many
  /// passes.
  static std::uint32_t digit_bits(std::uint32_t bits);
  static std::uint32_t passes(std::uint32_t bits);

  /// Sorts the first arguments[0].count pairs by the low `bits` bits of their keys, in whole digits; equal
  /// keys keep their order. `arguments` holds SortArguments for such digits. Afterwards pairs.keys() and
  /// pairs.values() are the sorted ones.
  void run(gl::Dispatcher& dispatcher, const gl::Buffer& arguments, PairBuffers& pairs, std::uint32_t bits);

 private:
  void run_looking_back(gl::Dispatcher& dispatcher, const gl::Buffer& arguments, PairBuffers& pairs,
                        std::uint32_t bits);

  gl::Buffer histogram_;        // by digit and block; where blocks look back, by block and digit
  gl::Buffer digits_;           // where blocks look back
  std::uint32_t half_now_ = 0;  // of its counts, the ones that are 0
  Scan scan_;
};

}  // namespace binosplat::primitives
