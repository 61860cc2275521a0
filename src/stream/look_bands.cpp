#include "stream/look_bands.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "base/frame_crew.h"

namespace binosplat {

namespace {

constexpr int bands_most = 12;      // each costs all that does not depend on pixels, too:
constexpr double fixed_most = 0.9;  // of what the fastest one takes
constexpr double nearly = 1.1;      // as fast as with more of them

/// Of those that show anything.
double fastest(const std::vector<double>& ms) {
  double least = *std::ranges::max_element(ms);
  for (const double of_band : ms)
    if (of_band >= LookBands::nothing_ms) least = std::min(least, of_band);
  return least;
}

/// In which a column of the view lies, at the height of its centre.
glm::vec3 along(const shared::View& view, double share) {
  const auto x = static_cast<float>(share) * static_cast<float>(view.width) - view.lens.z;
  return glm::vec3(view.row_z) + x / view.lens.x * glm::vec3(view.row_x);
}

/// The other way round; none where it is not in the picture.
std::optional<double> column(const shared::View& view, const glm::vec3& along) {
  const float ahead = glm::dot(along, glm::vec3(view.row_z)), right = glm::dot(along, glm::vec3(view.row_x));
  const double share = (right / ahead * view.lens.x + view.lens.z) / static_cast<float>(view.width);
  constexpr double rounding = 1e-4;
  if (!(ahead > 0.0f && share > -rounding && share < 1.0 + rounding)) return std::nullopt;
  return std::clamp(share, 0.0, 1.0);
}

/// Of bands from the left up to a column.
double sum_until(double share, const std::vector<double>& edges, const std::vector<double>& ms) {
  double sum = 0.0;
  for (std::size_t b = 0; b < ms.size() && edges[b] < share; ++b)
    sum += ms[b] * std::min(1.0, (share - edges[b]) / std::max(edges[b + 1] - edges[b], 1e-9));
  return sum;
}

}  // namespace

void LookBands::begin(const shared::View& view, double band_ms) {
  view_ = view;
  constexpr std::size_t slices = 64;  // equally wide
  std::array<double, slices> ms{};    // for pixels
  const auto side = [](std::size_t k) { return static_cast<double>(k) / double{slices}; };
  for (std::size_t k = 0; k < slices; ++k) ms[k] = expected(view, side(k), side(k + 1));
  const double all_ms = std::accumulate(ms.begin(), ms.end(), 0.0);
  const double enough_ms = std::max(band_ms, nearly * (fixed_ms_ + all_ms / most_));
  int bands = 1;
  while (bands < most_ && fixed_ms_ + all_ms / bands > enough_ms) ++bands;
  edges_ = {0.0};
  double before = 0.0;  // ms of the slices to the left of this one
  for (std::size_t k = 0; k < slices; before += ms[k++]) {
    while (count() + 1 < bands) {
      const double here = all_ms * static_cast<double>(edges_.size()) / bands - before;
      if (here > ms[k]) break;
      edges_.push_back(std::lerp(side(k), side(k + 1), here / std::max(ms[k], 1e-9)));
    }
  }
  edges_.push_back(1.0);
  ms_.assign(edges_.size() - 1, 0.0);
  at_ = 0;
}

// What was found last in these directions, for pixels, ms; where nobody looked, as much as in the mean of
// what was looked at last.
double LookBands::expected(const shared::View& view, double begin, double end) const {
  for (const Picture& picture : last_) {
    const auto left = column(picture.view, along(view, begin)),
               right = column(picture.view, along(view, end));
    if (left && right) {
      return std::max(
          0.0, sum_until(*right, picture.edges, picture.ms) - sum_until(*left, picture.edges, picture.ms));
    }
  }
  return last_.empty() ? 0.0 : (end - begin) * sum_until(1.0, last_.front().edges, last_.front().ms);
}

bool LookBands::note(double ms) {
  ms_[at_] = ms;
  if (++at_ < ms_.size()) return false;
  at_ = 0;
  const double all_ms = std::accumulate(ms_.begin(), ms_.end(), 0.0);
  find_fixed(all_ms);
  std::vector<double> of_pixels = ms_;
  for (double& of_band : of_pixels) of_band = std::max(0.0, of_band - fixed_ms_);
  last_.insert(last_.begin(), {view_, edges_, std::move(of_pixels), all_ms});
  if (last_.size() > 2) last_.pop_back();
  return true;
}

void LookBands::allow(int most) { most_ = std::clamp(most, 1, bands_most); }

// A picture of n bands takes n times what does not depend on pixels, and once what does: another number of
// bands tells them apart.
void LookBands::find_fixed(double all_ms) {
  const int before = last_.empty() ? count() : static_cast<int>(last_.front().ms.size());
  if (count() != before) fixed_ms_ = (all_ms - last_.front().all_ms) / (count() - before);
  fixed_ms_ = std::clamp(fixed_ms_, 0.0, fixed_most * fastest(ms_));
}

void add_band(const std::vector<SeenPart>& more, std::vector<SeenPart>& seen) {
  const auto add = [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const double area = seen[p].area + more[p].area;
      if (more[p].area == 0.0) continue;
      const double share = more[p].area / area;
      seen[p].distance = seen[p].area == 0.0
                             ? more[p].distance
                             : std::pow(seen[p].distance, 1.0 - share) * std::pow(more[p].distance, share);
      seen[p].area = area;
    }
  };
  frame_chunks(seen.size(), 1 << 12, add);
}

}  // namespace binosplat
