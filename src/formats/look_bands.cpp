#include "formats/look_bands.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace binosplat {

namespace {

constexpr double glance_ms = 4.5;   // that a frame may take for a look
constexpr int bands_most = 8;       // each costs all that does not depend on pixels, too:
constexpr double fixed_most = 0.9;  // of what the fastest one takes
constexpr double nearly = 1.1;      // as fast as with more of them

/// Of those that show anything.
double fastest(const std::vector<double>& ms) {
  double least = *std::ranges::max_element(ms);
  for (const double of_band : ms)
    if (of_band >= LookBands::nothing_ms) least = std::min(least, of_band);
  return least;
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

// A picture of n bands takes n times what does not depend on pixels, and once what does: another number of
// bands tells them apart.
void LookBands::find_fixed(double all_ms) {
  if (count() != before_) fixed_ms_ = (all_ms - before_ms_) / (count() - before_);
  before_ = count();
  before_ms_ = all_ms;
  fixed_ms_ = std::clamp(fixed_ms_, 0.0, fixed_most * fastest(ms_));
}

void LookBands::divide(int most) {
  find_fixed(std::accumulate(ms_.begin(), ms_.end(), 0.0));
  std::vector<double> ms = ms_;  // of each, that it takes for its pixels
  for (double& of_band : ms) of_band = std::max(0.0, of_band - fixed_ms_);
  const double all_ms = std::accumulate(ms.begin(), ms.end(), 0.0);
  most = std::clamp(most, 1, bands_most);
  const double enough_ms = std::max(glance_ms, nearly * (fixed_ms_ + all_ms / most));
  int bands = 1;
  while (bands < most && fixed_ms_ + all_ms / bands > enough_ms) ++bands;
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

void add_band(const std::vector<SeenPart>& more, std::vector<SeenPart>& seen) {
  for (std::size_t p = 0; p < seen.size(); ++p) {
    const double area = seen[p].area + more[p].area;
    if (more[p].area == 0.0) continue;
    const double share = more[p].area / area;
    seen[p].distance = seen[p].area == 0.0
                           ? more[p].distance
                           : std::pow(seen[p].distance, 1.0 - share) * std::pow(more[p].distance, share);
    seen[p].area = area;
  }
}

}  // namespace binosplat
