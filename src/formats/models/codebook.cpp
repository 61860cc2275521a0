#include "formats/models/codebook.h"

#include <algorithm>
#include <numeric>
#include <queue>

#include "base/parallel.h"
#include "base/parallel_sort.h"

namespace binosplat {

namespace {

constexpr std::size_t max_evenly_spaced = 64;
constexpr int rounds = 24;  // of Lloyd's algorithm; later rounds change the error by less than a hundredth

/// Returns prefix sums, which give the mean of any range of values.
std::vector<double> sums_of(const std::vector<float>& values) {
  std::vector<double> sums(values.size() + 1, 0.0);
  std::inclusive_scan(values.begin(), values.end(), sums.begin() + 1, std::plus<>(), 0.0);
  return sums;
}

struct Entry {
  double value = 0.0;
  bool stays = false;
};

/// Moves each free entry to the mean of the values that are nearest to it.
void move_to_means(std::vector<Entry>& entries, const std::vector<float>& values,
                   const std::vector<double>& sums) {
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.value < b.value; });
  std::vector<double> moved(entries.size());
  std::size_t begin = 0;
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const bool last = k + 1 == entries.size();
    const double end_value = last ? 0.0 : 0.5 * (entries[k].value + entries[k + 1].value);
    const auto end = last ? values.size()
                          : static_cast<std::size_t>(
                                std::lower_bound(values.begin(), values.end(), end_value) - values.begin());
    moved[k] = end > begin ? (sums[end] - sums[begin]) / static_cast<double>(end - begin) : entries[k].value;
    begin = std::max(begin, end);
  }
  for (std::size_t k = 0; k < entries.size(); ++k) {
    if (!entries[k].stays) entries[k].value = moved[k];
  }
}

/// A set of rows: those at [begin, end) in PaletteMaker::order_.
struct Cell {
  std::size_t begin = 0, end = 0;
  std::size_t axis = 0;  // column that varies most
  double middle = 0.0;   // mean of this column
  double error = 0.0;    // squared error, summed over rows and columns
  bool operator<(const Cell& other) const { return error < other.error; }
};

class PaletteMaker {
 public:
  PaletteMaker(std::size_t rows, std::size_t size, const std::function<const float*(std::size_t i)>& row)
      : size_(size), row_(row), order_(rows) {
    std::iota(order_.begin(), order_.end(), 0u);
  }

  Palette make(std::size_t most) {
    std::priority_queue<Cell> cells;
    std::vector<Cell> done;
    cells.push(measured(0, order_.size()));
    while (!cells.empty() && cells.size() + done.size() < most) {
      const Cell cell = cells.top();
      cells.pop();
      const auto begin = order_.begin() + static_cast<std::ptrdiff_t>(cell.begin);
      const auto end = order_.begin() + static_cast<std::ptrdiff_t>(cell.end);
      const auto cut =
          std::partition(begin, end, [&](std::uint32_t i) { return row_(i)[cell.axis] < cell.middle; });
      if (cut == begin || cut == end) {  // all rows are equal up to rounding
        done.push_back(cell);
        continue;
      }
      const auto at = static_cast<std::size_t>(cut - order_.begin());
      cells.push(measured(cell.begin, at));
      cells.push(measured(at, cell.end));
    }
    for (; !cells.empty(); cells.pop()) done.push_back(cells.top());
    return palette_of(done);
  }

 private:
  using Sums = std::vector<double>;

  /// Adds up add(row, sums) over rows, in a fixed order.
  template <typename Add>
  Sums sum(std::size_t begin, std::size_t end, const Add& add) const {
    constexpr std::size_t min_per_thread = 4096;
    if (end - begin <= min_per_thread) {
      Sums sums(size_, 0.0);
      for (std::size_t k = begin; k != end; ++k) add(row_(order_[k]), sums);
      return sums;
    }
    const std::size_t middle = begin + (end - begin) / 2;
    std::array<Sums, 2> halves;
    parallel_for(
        2, [&](int half) { halves[half] = half == 0 ? sum(begin, middle, add) : sum(middle, end, add); });
    std::ranges::transform(halves[0], halves[1], halves[0].begin(), std::plus<>());
    return std::move(halves[0]);
  }

  Sums mean(std::size_t begin, std::size_t end) const {
    Sums sums = sum(begin, end, [&](const float* row, Sums& s) {
      for (std::size_t d = 0; d < size_; ++d) s[d] += row[d];
    });
    for (double& s : sums) s /= static_cast<double>(end - begin);
    return sums;
  }

  Cell measured(std::size_t begin, std::size_t end) const {
    const Sums middle = mean(begin, end);
    const Sums errors = sum(begin, end, [&](const float* row, Sums& s) {
      for (std::size_t d = 0; d < size_; ++d) s[d] += (row[d] - middle[d]) * (row[d] - middle[d]);
    });
    const auto widest =
        static_cast<std::size_t>(std::max_element(errors.begin(), errors.end()) - errors.begin());
    return {begin, end, widest, middle[widest], std::accumulate(errors.begin(), errors.end(), 0.0)};
  }

  Palette palette_of(const std::vector<Cell>& cells) const {
    Palette palette{cells.size(), {}, std::vector<std::uint32_t>(order_.size())};
    palette.entries.reserve(cells.size() * size_);
    for (std::size_t label = 0; label < cells.size(); ++label) {
      const Sums middle = mean(cells[label].begin, cells[label].end);
      for (const double value : middle) palette.entries.push_back(static_cast<float>(value));
      for (std::size_t k = cells[label].begin; k < cells[label].end; ++k)
        palette.labels[order_[k]] = static_cast<std::uint32_t>(label);
    }
    return palette;
  }

  std::size_t size_;
  const std::function<const float*(std::size_t i)>& row_;
  std::vector<std::uint32_t> order_;
};

}  // namespace

Codebook::Codebook(std::vector<float> values) {
  parallel_sort(values.begin(), values.end());
  std::vector<float> different;
  std::unique_copy(values.begin(), values.end(), std::back_inserter(different));
  if (different.size() <= entries_.size()) {
    entries_.fill(different.back());
    std::copy(different.begin(), different.end(), entries_.begin());
    return;
  }
  const double low = values.front(), high = values.back();
  std::vector<Entry> entries;
  for (std::size_t k = 0; k < max_evenly_spaced; ++k)
    entries.push_back({low + (high - low) * static_cast<double>(k) / (max_evenly_spaced - 1), true});
  const std::size_t others = entries_.size() - max_evenly_spaced;
  for (std::size_t k = 0; k < others; ++k)
    entries.push_back({values[(2 * k + 1) * values.size() / (2 * others)], false});
  const std::vector<double> sums = sums_of(values);
  for (int n = 0; n < rounds; ++n) move_to_means(entries, values, sums);
  for (std::size_t k = 0; k < entries_.size(); ++k) entries_[k] = static_cast<float>(entries[k].value);
  std::sort(entries_.begin(), entries_.end());
}

std::uint8_t Codebook::nearest(float value) const {
  const auto above = std::lower_bound(entries_.begin(), entries_.end(), value);
  if (above == entries_.begin()) return 0;
  const bool below = above == entries_.end() || value - above[-1] < *above - value;
  return static_cast<std::uint8_t>(above - entries_.begin() - (below ? 1 : 0));
}

Palette make_palette(std::size_t rows, std::size_t size, std::size_t most,
                     const std::function<const float*(std::size_t i)>& row) {
  return PaletteMaker(rows, size, row).make(most);
}

}  // namespace binosplat
