// What is read of a streamed SOG first, and what stays that nothing needs any more.

#include <algorithm>
#include <cmath>
#include <functional>

#include "formats/streamed_sog.h"

namespace binosplat {

namespace {

// Of what is needed, that levels which are no longer needed may make a model larger by.
constexpr double stays_most = 0.5;

}  // namespace

// Finer levels of the choice before stay in this one until they were not needed for some seconds, those that
// were needed last first: as long as there is room.
void StreamedSog::stay(double seconds, std::size_t most) {
  const auto now = Clock::now();
  needed_.resize(leaves_.size());
  std::vector<std::size_t> staying;
  for (std::size_t leaf = 0; leaf < leaves_.size(); ++leaf) {
    const bool is_finer = before_.size() == leaves_.size() && before_[leaf] < chosen_[leaf];
    if (is_finer && ms_since(needed_[leaf]) < 1e3 * seconds) {
      staying.push_back(leaf);
    } else {
      needed_[leaf] = now;
    }
  }
  lingers_ = false;
  std::ranges::stable_sort(staying, std::greater<>(), [&](std::size_t leaf) { return needed_[leaf]; });
  const std::size_t needed = count(chosen_);
  std::size_t room = std::min(static_cast<std::size_t>(stays_most * static_cast<double>(needed)),
                              most - std::min(most, needed));
  for (const std::size_t leaf : staying) {
    const auto& levels = leaves_[leaf].levels;
    const std::size_t finer = levels[before_[leaf]].count, coarser = levels[chosen_[leaf]].count;
    if (finer > coarser + room) break;
    room -= finer - std::min(finer, coarser);
    chosen_[leaf] = before_[leaf];
    lingers_ = true;
  }
}

double StreamedSog::saved(std::size_t leaf, std::optional<std::size_t> before) const {
  return before ? choice_->saved(leaf, *before, chosen_[leaf]) : INFINITY;
}

double StreamedSog::worth(const Piece& piece) const {
  if (!choice_ || piece.part >= leaves_.size() || !piece.before || *piece.before < *piece.level)
    return INFINITY;
  return saved(piece.part, piece.before) / static_cast<double>(std::max<std::size_t>(piece.model.count(), 1));
}

}  // namespace binosplat
