#include "stream/level_chooser.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/log.h"

namespace binosplat {

namespace {

// Of what is needed, that levels which are no longer needed may make a model larger by.
constexpr double stays_most = 0.5;

}  // namespace

bool have_errors(const std::vector<DetailPart>& leaves) {
  return std::ranges::any_of(leaves, [](const DetailPart& leaf) { return !leaf.pixels.empty(); });
}

void warn_of_no_room(const std::string& name, std::size_t total, std::size_t most) {
  log_warning("{}: even its coarsest levels of detail have {} Gaussians, and there is room for {}", name,
              total, most);
}

std::shared_ptr<const LevelsChosen> LevelChooser::choose(std::span<const shared::View> views,
                                                         const DetailNeed& need, const DetailSeen& seen) {
  if (need.db && !have_errors(leaves_)) {
    fail(
        "--detail {}dB: {} has no errors of its levels to go by; `binosplat levels` writes them; or use "
        "--detail PX",
        *need.db, name_);
  }
  const std::size_t most = need.most - std::min(need.most, around_);
  const std::vector<DetailView> detail = detail_views(views);
  LevelsChosen chosen;
  if (need.db && !views.empty()) {
    chosen.by_errors = std::make_shared<const DetailChoice>(choose_levels_within(
        leaves_, detail, error_of_psnr(*need.db) / need.found, most, seen, before_, need.heads_turn));
    chosen.levels = chosen.by_errors->levels;
  } else {
    std::vector<glm::dvec3> eyes;
    double focal = 0.0;
    for (const DetailView& view : detail) {
      eyes.push_back(view.eye);
      focal = std::max(focal, view.focal);
    }
    const double enough = views.empty() ? std::numeric_limits<double>::infinity() : need.apart_px / focal;
    chosen.levels = choose_levels(leaves_, eyes, most, enough, before_);
  }
  // While more is needed than comes, nothing comes instead of what is there already.
  stay(chosen, chosen.is_limited() ? INFINITY : need.db ? need.stays_s : 0.0, need.most, seen.drawn);
  const std::size_t total = count(chosen.levels);
  if (total > need.most && !told_no_room_) warn_of_no_room(name_, total, need.most);
  told_no_room_ = total > need.most;
  before_ = views.empty() ? std::vector<std::size_t>() : chosen.levels;
  return std::make_shared<const LevelsChosen>(std::move(chosen));
}

std::size_t LevelChooser::count(std::span<const std::size_t> levels) const {
  std::size_t total = around_;
  for (std::size_t leaf = 0; leaf < leaves_.size(); ++leaf)
    total += leaves_[leaf].levels.empty() ? 0 : leaves_[leaf].levels[levels[leaf]].count;
  return total;
}

// Finer levels of the choice before stay in this one until they were not needed for some seconds, those that
// were needed last first: as long as there is room.
void LevelChooser::stay(LevelsChosen& chosen, double seconds, std::size_t most,
                        std::span<const std::size_t> drawn) {
  const auto now = Clock::now();
  needed_.resize(leaves_.size());
  std::vector<std::size_t> staying;
  const auto there = [&](std::size_t leaf) {  // what was chosen but has not come does not stay
    return drawn.empty() ? before_[leaf] : std::max(before_[leaf], drawn[leaf]);
  };
  for (std::size_t leaf = 0; leaf < leaves_.size(); ++leaf) {
    const bool is_finer = !before_.empty() && there(leaf) < chosen.levels[leaf];
    if (is_finer && ms_since(needed_[leaf]) < 1e3 * seconds) {
      staying.push_back(leaf);
    } else {
      needed_[leaf] = now;
    }
  }
  std::ranges::stable_sort(staying, std::greater<>(), [&](std::size_t leaf) { return needed_[leaf]; });
  const std::size_t needed = count(chosen.levels);
  std::size_t room = std::min(static_cast<std::size_t>(stays_most * static_cast<double>(needed)),
                              most - std::min(most, needed));
  for (const std::size_t leaf : staying) {
    const auto& levels = leaves_[leaf].levels;
    const std::size_t finer = levels[there(leaf)].count, coarser = levels[chosen.levels[leaf]].count;
    if (finer > coarser + room) break;
    room -= finer - std::min(finer, coarser);
    chosen.levels[leaf] = there(leaf);
    chosen.lingers = true;
  }
}

}  // namespace binosplat
