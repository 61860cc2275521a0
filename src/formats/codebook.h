#pragma once
// Few values in place of many, as SOG stores them: a codebook of 256 numbers, and a palette of rows of
// numbers.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace binosplat {

/// 256 numbers in ascending order. Up to 256 different values are kept as they are. Of more, 64 lie evenly
/// between the ends, so that no value is farther from its nearest than 1 / 126 of the range; the others where
/// the squared error is least (Lloyd 1982). The values must not be empty; they are sorted.
class Codebook {
 public:
  explicit Codebook(std::vector<float> values);

  const std::array<float, 256>& entries() const { return entries_; }
  /// The place of the entry nearest to a value.
  std::uint8_t nearest(float value) const;

 private:
  std::array<float, 256> entries_;
};

struct Palette {
  std::size_t count = 0;
  std::vector<float> entries;         // (count, size of a row)
  std::vector<std::uint32_t> labels;  // by row
};

/// At most `most` rows in place of `rows`, each the mean of those that it stands for: the box of rows with
/// the largest squared error is cut in two at its mean, across its longest spread, again and again. Rows that
/// are not more than `most` are kept as they are. `row(i)` gives the first of its `size` numbers.
Palette make_palette(std::size_t rows, std::size_t size, std::size_t most,
                     const std::function<const float*(std::size_t i)>& row);

}  // namespace binosplat
