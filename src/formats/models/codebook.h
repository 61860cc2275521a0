#pragma once
// Quantisation for SOG: a codebook of 256 numbers, and a palette of rows of numbers.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace binosplat {

/// 256 numbers in ascending order. If there are up to 256 different values, these are the entries. Otherwise
/// 64 entries are spaced evenly over the range of the values, so that each value is at most 1 / 126 of the
/// range from an entry. The other 192 minimise the squared error (Lloyd 1982). `values` must not be empty.
class Codebook {
 public:
  explicit Codebook(std::vector<float> values);

  const std::array<float, 256>& entries() const { return entries_; }
  std::uint8_t nearest(float value) const;

 private:
  std::array<float, 256> entries_;
};

struct Palette {
  std::size_t count = 0;
  std::vector<float> entries;         // `count` rows of numbers
  std::vector<std::uint32_t> labels;  // index of each row's entry
};

/// Replaces `rows` rows by at most `most` entries, each the mean of a set of rows. Repeatedly divides the set
/// with the largest squared error in two, at the mean of the column that varies most. If there are up to
/// `most` different rows, these are the entries. `row(i)` returns a pointer to the `size` numbers of row i.
Palette make_palette(std::size_t rows, std::size_t size, std::size_t most,
                     const std::function<const float*(std::size_t i)>& row);

}  // namespace binosplat
