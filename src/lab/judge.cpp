#include "lab/judge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "stereo/disagreement.h"

namespace binosplat::lab {

namespace {

struct Sum {
  double squares = 0.0;
  double count = 0.0;

  void add(double error) {
    squares += error * error;
    count += 1.0;
  }
  void add(const Sum& other) {
    squares += other.squares;
    count += other.count;
  }
  double rms() const { return count > 0.0 ? std::sqrt(squares / count) : 0.0; }
};

bool at_edge(int at, int size, int tile) { return at % tile == 0 || at % tile == tile - 1 || at == size - 1; }

// What a row of pixels adds.
struct Row {
  Sum edge, inside;
  double sum = 0.0;
};

float shown(float value) { return std::clamp(value, 0.0f, 1.0f); }

// Row y of a picture; `sizes`: where the absolute errors of its channels go.
Row judge_row(const Picture& exact, const Picture& approximate, int y, int tile_size, float* sizes) {
  Row row;
  const std::size_t first = static_cast<std::size_t>(y) * static_cast<std::size_t>(exact.width);
  for (int x = 0; x < exact.width; ++x) {
    const glm::vec4& a = approximate.colour[first + static_cast<std::size_t>(x)];
    const glm::vec4& b = exact.colour[first + static_cast<std::size_t>(x)];
    Sum& part =
        at_edge(x, exact.width, tile_size) || at_edge(y, exact.height, tile_size) ? row.edge : row.inside;
    for (int c = 0; c < 3; ++c) {
      const float error = shown(a[c]) - shown(b[c]);
      part.add(error);
      row.sum += error;
      *sizes++ = std::abs(error);
    }
  }
  return row;
}

}  // namespace

FrameErrors judge(std::span<const shared::View> views, std::span<const Picture> exact,
                  std::span<const Picture> approximate, int tile_size) {
  if (exact.empty() || exact.size() != approximate.size() || exact.size() != views.size())
    fail("{} exact and {} approximate pictures of {} views: expected one each", exact.size(),
         approximate.size(), views.size());
  FrameErrors errors;
  Sum edge, inside;
  std::vector<float> sizes;
  double sum = 0.0;
  for (std::size_t v = 0; v < exact.size(); ++v) {
    const Picture &a = approximate[v], &b = exact[v];
    if (a.width != b.width || a.height != b.height)
      fail("pictures of {} x {} and {} x {} px: expected one size", a.width, a.height, b.width, b.height);
    const std::size_t first = sizes.size();
    sizes.resize(first + 3 * a.colour.size());
    // One sum a row, added up in order: the same number whatever the threads do.
    std::vector<Row> rows(static_cast<std::size_t>(a.height));
    parallel_for(a.height, [&](int y) {
      float* const of_row = sizes.data() + first + std::size_t{3} * static_cast<std::size_t>(y) * a.width;
      rows[static_cast<std::size_t>(y)] = judge_row(b, a, y, tile_size, of_row);
    });
    for (const Row& row : rows) {
      edge.add(row.edge);
      inside.add(row.inside);
      sum += row.sum;
    }
  }
  const double squares = edge.squares + inside.squares;
  errors.psnr = squares > 0.0 ? -10.0 * std::log10(squares / (edge.count + inside.count))
                              : std::numeric_limits<double>::infinity();
  errors.signed_mean = sum / static_cast<double>(sizes.size());
  errors.largest = *std::max_element(sizes.begin(), sizes.end());
  const auto rank = sizes.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(sizes.size() - 1));
  std::nth_element(sizes.begin(), rank, sizes.end());
  errors.p99 = *rank;
  errors.edges = squares > 0.0 ? edge.rms() / inside.rms() : 1.0;
  errors.disagreement = views.size() == 2
                            ? stereo::disagreement(std::array{views[0], views[1]}, exact, approximate).db
                            : std::numeric_limits<double>::quiet_NaN();
  return errors;
}

}  // namespace binosplat::lab
