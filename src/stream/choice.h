#pragma once
// Which level of detail each chunk of a model gets: functions of the chunks, of what views show of them, and
// of how many Gaussians and how much error are allowed. The same arguments give the same levels.

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "formats/sog_levels.h"
#include "shared/types.h"

namespace binosplat {

/// Of so few Gaussians, coarser levels save less of a moving head's frames (0.1 to 0.3 ms on an H200) than
/// visibility passes take (0.3 in the mean).
inline constexpr std::size_t few_gaussians = 1 << 19;

inline constexpr std::size_t any_number = std::numeric_limits<std::size_t>::max();

/// What is asked of the levels of a frame.
struct DetailRequest {
  double apart_px = 0.0;  // chunks whose Gaussians are seen no farther apart are fine enough; 0: none is
  std::size_t most = any_number;      // Gaussians of the model
  std::optional<double> db = {};      // instead of apart_px: each view's PSNR against the finest levels
  bool heads_turn = true;             // by dB: what is out of view may be seen a moment later
  double calibration = 1.0;           // by dB: what levels lose, as a multiple of what is predicted
  std::size_t most_new = any_number;  // by dB: Gaussians that may have to be read, or one chunk's
};

// Levels and what a frame leaves out of them (FrameSettings::quality) share a budget where their squared
// errors are known, which add up.

/// The levels' part of so many dB: half of the squared error.
double levels_share(double together_db);
/// What levels with `levels_db` leave of it for a frame, dB: a tenth of the squared error at least.
double left_of(double together_db, double levels_db);
/// Of two PSNR in dB that of both errors together.
double psnr_of_both(double a_db, double b_db);
/// In dB what a squared error is, of colours up to 1; and the other way round.
double psnr_of_error(double squared);
double error_of_psnr(double db);

/// One of `detail_directions`.
glm::dvec3 detail_direction(std::size_t d);

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

/// What a view shows of a chunk: alpha T^2, summed over its Gaussians and the view's pixels, and how far away
/// that is, world units. T once for the light that comes from it, and once since an error behind others is
/// seen less. A little where all of it is hidden; 0 only where none of its Gaussians is in the picture.
struct ChunkVisibility {
  double area = 0.0;  // px
  double distance = 0.0;
};

/// What views were measured to show of chunks, maybe a moment ago. Empty where nothing was measured.
struct VisibleChunks {
  std::vector<std::vector<ChunkVisibility>> by_view;
  std::vector<std::size_t> drawn;  // the places of the levels that were drawn, by chunk
};

/// For each chunk the place of its level in LodChunk::levels, and what any other levels would lose.
struct LevelChoice {
  std::vector<std::size_t> levels;
  bool is_limited = false;  // more is needed than may be read (DetailRequest::most_new)
  // Where dB are gone by:
  std::vector<double> pixels;  // of the views
  double sphere_pixels = 0.0;  // of the sphere around them
  /// By chunk: squared error by view, of each of its levels, summed over pixels; at the end that of the
  /// sphere around the views. In one list, of which `first` says where a chunk's begin, and the last one's
  /// end.
  std::vector<double> errors;
  std::vector<std::size_t> first;

  bool knows_errors() const { return !first.empty(); }
  /// What the view that loses most does with any levels of the chunks: squared, meaned over pixels and
  /// channels.
  double error_of(std::span<const std::size_t> any_levels) const;
  double error() const { return error_of(levels); }
  /// What one view loses so.
  double error_of_view(std::size_t view, std::span<const std::size_t> any_levels) const;
  /// What a view loses by a chunk: squared, meaned over its pixels and channels.
  double lost(std::size_t view, std::size_t chunk, std::size_t level) const {
    return errors[first[chunk] + view * levels_of(chunk) + level] / pixels[view];
  }
  /// By how much less the view that gains most of it, or the sphere, loses with a chunk at a level instead of
  /// another: squared, meaned over pixels and channels.
  double saved(std::size_t chunk, std::size_t from, std::size_t to) const;

  std::size_t levels_of(std::size_t chunk) const {
    return (first[chunk + 1] - first[chunk]) / (pixels.size() + 1);
  }
};

/// The choice for views of one frame, in the model's frame: choose_within() by dB, else choose_apart() by the
/// nearest eye and the longest focal length; without views the coarsest. `before` is the choice before it.
LevelChoice choose_levels(const std::vector<LodChunk>& chunks, std::span<const shared::View> views,
                          const DetailRequest& request, const VisibleChunks& visible = {},
                          std::span<const std::size_t> before = {});

/// All begin with their coarsest; then, as long as there is room, that chunk gets its next finer level whose
/// Gaussians lie farthest apart as the nearest eye sees them: the box's diagonal by the root of the count,
/// over the distance to the box, in radians; chunks where that is no more than `enough` stay as they are. The
/// choice is one for all eyes. More than `most` only if the coarsest levels are more already. `before`, a
/// choice for the same chunks, is kept to where the eyes have moved by little: its levels count as a tenth
/// more needed, finer ones as a tenth less.
std::vector<std::size_t> choose_apart(const std::vector<LodChunk>& chunks,
                                      const std::vector<glm::dvec3>& eyes, std::size_t most,
                                      double enough = 0.0, std::span<const std::size_t> before = {});

struct ErrorBudget {
  double error = 0.0;             // of each view: squared, meaned over pixels and channels
  std::size_t most = any_number;  // Gaussians,
  bool heads_turn = true;
  std::size_t most_new = any_number;  // as DetailRequest has them
};

/// Few Gaussians with which each view loses no more than is allowed. All chunks begin with their coarsest
/// level; then, as long as a view loses more, that chunk gets that finer level which saves the most error per
/// Gaussian. The choice is one for all views. Where nothing was measured, nothing is taken to hide anything.
/// Chunks that no view sees are refined, too, since heads turn: each is taken to be as hidden as the others
/// are on the whole, until all of them together lose no more than is allowed of the pixels of a whole sphere.
/// Where heads do not turn they keep their coarsest level. A chunk of unknown errors gets its finest level.
/// More Gaussians, and more error, only where they leave no choice, but for a thousandth of `most` that is
/// left. `before` is kept to: its levels go on until a tenth less is lost, finer ones end at a tenth more.
LevelChoice choose_within(const std::vector<LodChunk>& chunks, const std::vector<DetailView>& views,
                          const ErrorBudget& budget, const VisibleChunks& visible = {},
                          std::span<const std::size_t> before = {});

/// A level's squared error for each pixel's worth that is seen of the chunk (ChunkVisibility), by an eye that
/// looks `along`, of any length, where pixels are so wide, world units: by lines between the logarithms of
/// what is known. For wider pixels than the file knows it is the error at the widest; for narrower ones it
/// goes on as for detail that grows ever finer.
double relative_error(const LodChunk& chunk, std::size_t level, double width, const glm::dvec3& along);

/// What views lose with levels that change a few at a time: a frame has no time to sum up all chunks.
class RunningError {
 public:
  /// Of all chunks, once; by a choice that knows errors.
  RunningError(std::shared_ptr<const LevelChoice> choice, std::vector<std::size_t> levels);
  /// Goes by these levels of the chunks from now on.
  void follow(std::span<const std::size_t> levels);
  /// The error of the worst view of [begin, end) (LevelChoice::error_of), but for rounding.
  double error(std::size_t begin, std::size_t end) const;
  std::size_t views() const { return lost_.size(); }

 private:
  std::shared_ptr<const LevelChoice> choice_;
  std::vector<std::size_t> levels_;
  std::vector<double> lost_;  // by view
};

}  // namespace binosplat
