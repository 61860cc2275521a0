#pragma once
// Levels of detail that are chosen anew as views change.

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "shared/types.h"
#include "stream/detail.h"

namespace binosplat {

/// By dB: so many looks at the same views, since after them a choice hardly changes any more.
inline constexpr int looks_most = 3;

/// A level for each leaf of a streamed SOG.
struct LevelsChosen {
  std::vector<std::size_t> levels;  // places among those that are there
  /// What the views that they are for lose, at whatever levels; none where dB were not chosen by.
  std::shared_ptr<const DetailChoice> by_errors;
  bool lingers = false;  // some are finer than needed, and stay (DetailNeed::stays_s)

  /// More is needed than may come (DetailChoice).
  bool is_limited() const { return by_errors && by_errors->is_limited; }
};

class LevelChooser {
 public:
  /// Of these leaves, which must outlive it; `around` Gaussians more belong to every level. The name is for
  /// messages.
  LevelChooser(std::string name, const std::vector<DetailPart>& leaves, std::size_t around)
      : name_(std::move(name)), leaves_(leaves), around_(around) {}

  /// Chooses the same for all views, which are those of one frame in the model's frame; by the nearest eye
  /// and the longest focal length of them, wherever they look (choose_levels), or by what each of them loses
  /// (choose_levels_within, which `seen` is for), with the levels of the last choice as those before. Without
  /// views: the coarsest. Throws Error for dB where the file has no errors.
  std::shared_ptr<const LevelsChosen> choose(std::span<const shared::View> views, const DetailNeed& need,
                                             const DetailSeen& seen = {});
  /// There is no choice before the next one.
  void forget() { before_.clear(); }

  /// Gaussians at such levels of the leaves.
  std::size_t count(std::span<const std::size_t> levels) const;

 private:
  void stay(LevelsChosen& chosen, double seconds, std::size_t most, std::span<const std::size_t> drawn);

  std::string name_;
  const std::vector<DetailPart>& leaves_;
  std::size_t around_;
  std::vector<std::size_t> before_;        // that of the last views; empty: none
  std::vector<Clock::time_point> needed_;  // when the chosen levels of the leaves were last
  bool told_no_room_ = false;
};

/// That not even the coarsest levels fit.
void warn_of_no_room(const std::string& name, std::size_t total, std::size_t most);

/// Whether leaves say what their levels lose.
bool have_errors(const std::vector<DetailPart>& leaves);

}  // namespace binosplat
