#pragma once
// Which level of detail each part of a model gets, where there is room for so many Gaussians.

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "formats/sog_levels.h"
#include "scene/model_parts.h"
#include "shared/types.h"

namespace binosplat {

/// Of so few, coarser levels save less of a moving head's frames (0.1 to 0.3 ms on an H200) than looks (0.3
/// in the mean) and samples (0.15) take.
inline constexpr std::size_t few_gaussians = 1 << 19;

/// What the levels of a frame go by.
struct DetailNeed {
  double apart_px = 0.0;  // parts whose Gaussians are seen no farther apart are fine enough; 0: none is
  std::size_t most = std::numeric_limits<std::size_t>::max();  // Gaussians of the model
  std::optional<double> db = {};  // instead of apart_px: each view's PSNR against the finest levels
  bool heads_turn = true;         // by dB: what is out of sight may be seen a moment later
  /// By dB: for so long finer levels stay than are needed, where there is room; longer, where more is needed
  /// than comes (DetailSeen::to_come).
  double stays_s = 0.0;
  double found = 1.0;   // by dB: what levels were found to lose, of what is predicted (stream/level_sample.h)
  bool shares = false;  // nothing was asked for: levels may lose a part of what frames may
};

// Levels and what a frame leaves out of them (FrameSettings::quality) share a budget where their squared
// errors are known, which add up: so many dB together.

/// The levels' part of it, dB: half of the squared error.
double levels_share(double together_db);
/// What is left for a frame, dB, with levels that are taken to have `now_db`. While they have less than the
/// `asked_db` they were chosen for, others are under way, and a frame need not make up for it.
double left_of(double together_db, double asked_db, double now_db);
/// Of two PSNR in dB that of both errors together.
double psnr_of_both(double a_db, double b_db);
/// In dB what a squared error is, of colours up to 1; and the other way round.
double psnr_of_error(double squared);
double error_of_psnr(double db);

/// One of `detail_directions`.
glm::dvec3 detail_direction(std::size_t d);

/// For each part the place of its level in `levels`. All begin with their coarsest; then, as long as there is
/// room, that part gets its next finer one whose Gaussians lie farthest apart as the nearest eye sees them:
/// the box's diagonal by the root of the count, over the distance to the box, in radians; parts where that is
/// no more than `enough` stay as they are. The choice is one for all eyes. More than `most` only if the
/// coarsest levels are more already. `before`, a choice for the same parts, is kept to where the eyes have
/// moved by little: its levels count as a tenth more needed, finer ones as a tenth less.
std::vector<std::size_t> choose_levels(const std::vector<DetailPart>& parts,
                                       const std::vector<glm::dvec3>& eyes, std::size_t most,
                                       double enough = 0.0, std::span<const std::size_t> before = {});

/// A view, in the model's frame.
struct DetailView {
  glm::dvec3 eye{0.0};
  /// Of length 1, at right angles to the planes through the eye and the picture's sides, towards it; last
  /// that straight ahead. 0: sees all around.
  std::array<glm::dvec3, 5> inward{};
  double focal = 1.0;   // px
  double pixels = 1.0;  // of the picture
};
std::vector<DetailView> detail_views(std::span<const shared::View> views);

/// A level's squared error for each pixel's worth that is seen of the part (SeenPart), by an eye that looks
/// `along`, of any length, where pixels are so wide, world units: by lines between the logarithms of what is
/// known. Narrower ones lose as much as detail does that grows finer and finer, wider ones as at the end.
double relative_error(const DetailPart& part, std::size_t level, double width, const glm::dvec3& along);

/// What views were found to show of parts, maybe a moment ago. Empty where nobody looked.
struct DetailSeen {
  std::vector<std::vector<SeenPart>> by_view;
  std::vector<std::size_t> drawn;  // the places of the levels that were looked at, by part
  /// So many Gaussians of finer levels than these may be chosen, or one part's: more do not come in time.
  std::size_t to_come = std::numeric_limits<std::size_t>::max();
};

struct DetailChoice {
  std::vector<std::size_t> levels;  // as choose_levels says them
  std::vector<double> pixels;       // of the views
  double sphere_pixels = 0.0;       // of the sphere around them
  /// By part: squared error by view, of each of its levels, summed over pixels; at the end that of the sphere
  /// around the views. In one list, of which `first` says where a part's begin, and the last one's end.
  std::vector<double> errors;
  std::vector<std::size_t> first;
  bool is_limited = false;  // more is needed than may come (DetailSeen::to_come)

  /// What that of some views, from `begin` to before `end`, which loses most does with any levels of the
  /// parts: squared, meaned over pixels and channels.
  double error_of(std::span<const std::size_t> any_levels, std::size_t begin, std::size_t end) const;
  double error_of(std::span<const std::size_t> any_levels) const {
    return error_of(any_levels, 0, pixels.size());
  }
  double error() const { return error_of(levels); }
  /// What a view loses by a part: squared, meaned over its pixels and channels.
  double lost(std::size_t view, std::size_t part, std::size_t level) const {
    return errors[first[part] + view * levels_of(part) + level] / pixels[view];
  }
  /// By how much less the view that gains most of it, or the sphere, loses with a part at a level instead of
  /// another: squared, meaned over pixels and channels.
  double saved(std::size_t part, std::size_t from, std::size_t to) const;

  std::size_t levels_of(std::size_t part) const {
    return (first[part + 1] - first[part]) / (pixels.size() + 1);
  }
};

/// What views lose with levels that change a few at a time: a frame has no time for those of all parts.
class LevelsLost {
 public:
  /// Of all parts, once.
  LevelsLost(std::shared_ptr<const DetailChoice> choice, std::vector<std::size_t> levels);
  const DetailChoice& choice() const { return *choice_; }
  /// Goes by these levels of the parts from now on.
  void follow(std::span<const std::size_t> levels);
  /// DetailChoice::error_of them, but for rounding.
  double error(std::size_t begin, std::size_t end) const;

 private:
  std::shared_ptr<const DetailChoice> choice_;
  std::vector<std::size_t> levels_;
  std::vector<double> lost_;  // by view
};

/// The same by errors: few Gaussians with which each view loses no more than `error`, squared and meaned. All
/// parts begin with their coarsest level; then, as long as a view loses more, that part gets that finer level
/// which saves the most error per Gaussian. The choice is one for all views. What nobody looked at is taken
/// to be hidden by nothing. A part that no view sees takes part in this as if it were seen, and as hidden as
/// others are on the whole, and goes on until all such parts lose no more than `error` of the pixels of a
/// whole sphere; unless `heads_turn` is false: then it keeps its coarsest. A part of unknown errors gets its
/// finest level. More than `most`, and more error, only where they leave no choice, but for a thousandth of
/// `most` that is left. `before` is kept to: its levels go on until a tenth less is lost, finer ones end at a
/// tenth more.
DetailChoice choose_levels_within(const std::vector<DetailPart>& parts, const std::vector<DetailView>& views,
                                  double error, std::size_t most, const DetailSeen& seen = {},
                                  std::span<const std::size_t> before = {}, bool heads_turn = true);

}  // namespace binosplat
