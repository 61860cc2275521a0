#include "formats/look_bands.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace binosplat {

namespace {

constexpr double glance_ms = 3.0;  // that a frame may take for a look
constexpr int bands_most = 8;      // each costs all that does not depend on pixels, too:
constexpr double fixed = 0.8;      // of what the fastest one takes

/// What a band takes whatever it shows. Bands too narrow to show anything take less.
double fixed_of(const std::vector<double>& ms) {
  if (ms.size() == 1) return 0.0;
  std::vector<double> sorted = ms;
  std::ranges::sort(sorted);
  return fixed * *std::ranges::lower_bound(sorted, 0.5 * sorted[sorted.size() / 2]);
}

}  // namespace

bool LookBands::note(double ms) {
  ms_[at_] = is_known_ ? std::min(ms_[at_], ms) : ms;
  if (++at_ < ms_.size()) return false;
  at_ = 0;
  is_known_ = true;
  return true;
}

void LookBands::start_again() {
  at_ = 0;
  is_known_ = false;
}

void LookBands::divide(int most) {
  const double fixed_ms = fixed_of(ms_);
  std::vector<double> ms = ms_;  // of each, that it takes for its pixels
  for (double& of_band : ms) of_band = std::max(0.0, of_band - fixed_ms);
  const double all_ms = std::accumulate(ms.begin(), ms.end(), 0.0);
  const double needed = std::ceil(all_ms / std::max(glance_ms - fixed_ms, 1e-3));
  const auto bands = static_cast<int>(std::clamp(needed, 1.0, double(std::min(most, bands_most))));
  std::vector<double> edges = {0.0};
  double before = 0.0;  // ms of the bands to the left of this one
  for (std::size_t k = 0; k < ms.size(); before += ms[k++]) {
    while (static_cast<int>(edges.size()) < bands) {
      const double here = all_ms * static_cast<double>(edges.size()) / bands - before;
      if (here > ms[k]) break;
      edges.push_back(std::lerp(edges_[k], edges_[k + 1], here / std::max(ms[k], 1e-9)));
    }
  }
  edges.push_back(1.0);
  edges_ = std::move(edges);
  ms_.assign(edges_.size() - 1, 0.0);
  start_again();
}

}  // namespace binosplat
