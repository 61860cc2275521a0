#include "study/judge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "base/error.h"
#include "stereo/disagreement.h"

namespace binosplat::study {

namespace {

struct Sum {
  double squares = 0.0;
  double count = 0.0;

  void add(double error) {
    squares += error * error;
    count += 1.0;
  }
  double rms() const { return count > 0.0 ? std::sqrt(squares / count) : 0.0; }
};

bool at_edge(int at, int size, int tile) { return at % tile == 0 || at % tile == tile - 1 || at == size - 1; }

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
    const Image a = composite(approximate[v], glm::vec3(0.0f)), b = composite(exact[v], glm::vec3(0.0f));
    if (a.width != b.width || a.height != b.height)
      fail("pictures of {} x {} and {} x {} px: expected one size", a.width, a.height, b.width, b.height);
    for (std::size_t k = 0; k < a.data.size(); ++k) {
      const int x = static_cast<int>(k / 3) % a.width, y = static_cast<int>(k / 3) / a.width;
      const float error = std::clamp(a.data[k], 0.0f, 1.0f) - std::clamp(b.data[k], 0.0f, 1.0f);
      (at_edge(x, a.width, tile_size) || at_edge(y, a.height, tile_size) ? edge : inside).add(error);
      sizes.push_back(std::abs(error));
      sum += error;
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

}  // namespace binosplat::study
