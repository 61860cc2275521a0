#pragma once
// Quantisation for SOG: a codebook of 256 numbers, and a palette of rows of numbers.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace binosplat {

/// 256 numbers in ascending order. Up to 256 different values are kept exactly. Of more values, 64 entries
/// lie evenly between the ends, so that each value is at most 1 / 126 of the range from an entry. The others
/// minimise the squared error (Lloyd 1982). Sorts the values, which must not be empty.
class Codebook {
 public:
  explicit Codebook(std::vector<float> values);

  const std::array<float, 256>& entries() const { return entries_; }
  /// Returns the index of the entry nearest to a value.
  std::uint8_t nearest(float value) const;

 private:
  std::array<float, 256> entries_;
};

struct Palette {
  std::size_t count = 0;
  std::vector<float> entries;         // (count, size of a row)
  std::vector<std::uint32_t> labels;  // by row
};

/// Replaces `rows` by at most `most` entries, each the mean of its rows. Repeatedly splits the cell with the
/// largest squared error at its mean, across its longest spread. Up to `most` rows are kept exactly. `row(i)`
/// returns a pointer to the row's `size` numbers.
Palette make_palette(std::size_t rows, std::size_t size, std::size_t most,
                     const std::function<const float*(std::size_t i)>& row);

}  // namespace binosplat
