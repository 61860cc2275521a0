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

/// In models of up to this many Gaussians, coarser levels save less of a moving head's frames (0.1 to 0.3 ms
/// on an H200) than visibility passes take (0.3 in the mean).
inline constexpr std::size_t few_gaussians = 1 << 19;

inline constexpr std::size_t any_number = std::numeric_limits<std::size_t>::max();

/// What is asked of the levels of a frame.
struct DetailRequest {
  double apart_px = 0.0;  // a chunk is fine enough whose Gaussians are seen no farther apart; 0: none is
  std::size_t most = any_number;      // Gaussians that the model may have
  std::optional<double> db = {};      // instead of apart_px: each view's PSNR against the finest levels
  bool heads_turn = true;             // by dB: refine what is out of view, too, since heads turn
  double calibration = 1.0;           // by dB: what levels lose, as a multiple of what is predicted
  std::size_t most_new = any_number;  // by dB: Gaussians that may have to be read; one chunk always may
};

// Levels and what a frame leaves out of them (FrameSettings::quality) share a budget where their squared
// errors are known, which add up.

/// The dB that levels must keep where levels and frame together must keep `together_db`: levels may lose half
/// of the squared error.
double levels_share(double together_db);
/// The dB that the frame must then keep where levels keep `levels_db`: it may lose the rest of the squared
/// error, and a tenth of it at least.
double left_of(double together_db, double levels_db);
/// The PSNR of two errors together, of which each alone has these PSNR, dB.
double psnr_of_both(double a_db, double b_db);
/// The PSNR in dB of a squared error of colours up to 1; and the other way round.
double psnr_of_error(double squared);
double error_of_psnr(double db);

/// The unit vector of direction `d` of detail_directions.
glm::dvec3 detail_direction(std::size_t d);

/// A view, in the model's frame.
struct DetailView {
  glm::dvec3 eye{0.0};
  /// Unit normals of the planes through the eye and the picture's sides, towards the picture; the last one
  /// points straight ahead. All 0: the view sees all around.
  std::array<glm::dvec3, 5> inward{};
  double focal = 1.0;   // px
  double pixels = 1.0;  // how many the picture has
};
std::vector<DetailView> detail_views(std::span<const shared::View> views);

/// What a view shows of a chunk: alpha T^2, summed over its Gaussians and the view's pixels, and how far away
/// that is, world units. One T is for the light that comes from it, the other since an error behind others is
/// seen less. The sum is small where all of the chunk is hidden, and 0 only where none of its Gaussians is in
/// the picture.
struct ChunkVisibility {
  double area = 0.0;  // px
  double distance = 0.0;
};

/// What a visibility pass measured, maybe a moment ago. Empty where nothing was measured.
struct VisibleChunks {
  std::vector<std::vector<ChunkVisibility>> by_view;
  std::vector<std::size_t> drawn;  // by chunk, the level that the pass drew, as its place in LodChunk::levels
};

/// The level chosen for each chunk, as its place in LodChunk::levels, and what any other levels would lose.
struct LevelChoice {
  std::vector<std::size_t> levels;
  bool is_limited = false;  // more is needed than may be read (DetailRequest::most_new)
  // Filled where levels are chosen by dB:
  std::vector<double> pixels;  // how many each view has
  double sphere_pixels = 0.0;  // how many the sphere around the views has
  /// Squared errors summed over pixels, by chunk, then view (the sphere comes last), then level, in one list.
  /// `first` has the place where each chunk's errors begin, and at its end the length of the list.
  std::vector<double> errors;
  std::vector<std::size_t> first;

  bool knows_errors() const { return !first.empty(); }
  /// The error of the view that loses most with any levels of the chunks: squared, meaned over pixels and
  /// channels.
  double error_of(std::span<const std::size_t> any_levels) const;
  double error() const { return error_of(levels); }
  /// The same of one view.
  double error_of_view(std::size_t view, std::span<const std::size_t> any_levels) const;
  /// The part of it that one chunk at a level causes.
  double lost(std::size_t view, std::size_t chunk, std::size_t level) const {
    return errors[first[chunk] + view * levels_of(chunk) + level] / pixels[view];
  }
  /// The error that a chunk saves at level `to` instead of `from`, in the view, or the sphere, where that is
  /// most: squared, meaned over pixels and channels.
  double saved(std::size_t chunk, std::size_t from, std::size_t to) const;

  std::size_t levels_of(std::size_t chunk) const {
    return (first[chunk + 1] - first[chunk]) / (pixels.size() + 1);
  }
};

/// Chooses levels for the views of one frame, given in the model's frame of reference: by choose_within()
/// where dB are asked for, else by choose_apart() with the longest focal length; without views the coarsest.
/// `before` is the choice before it.
LevelChoice choose_levels(const std::vector<LodChunk>& chunks, std::span<const shared::View> views,
                          const DetailRequest& request, const VisibleChunks& visible = {},
                          std::span<const std::size_t> before = {});

/// All chunks begin with their coarsest level. Then, as long as there is room, the chunk whose Gaussians lie
/// farthest apart, as the nearest eye sees them, gets its next finer level. How far that is, in radians, is
/// the box's diagonal by the root of the count of Gaussians, over the distance to the box; a chunk where it
/// is no more than `enough` stays as it is. The choice is one for all eyes. It has more than `most` Gaussians
/// only if the coarsest levels have. To keep levels steady while eyes move little, spacings count as a tenth
/// larger for steps to levels no finer than the chunk's in `before` (a choice for the same chunks), and as a
/// tenth smaller for steps to finer ones.
std::vector<std::size_t> choose_apart(const std::vector<LodChunk>& chunks,
                                      const std::vector<glm::dvec3>& eyes, std::size_t most,
                                      double enough = 0.0, std::span<const std::size_t> before = {});

struct ErrorBudget {
  double error = 0.0;  // that each view may have: squared, meaned over pixels and channels
  // As DetailRequest has them:
  std::size_t most = any_number;
  bool heads_turn = true;
  std::size_t most_new = any_number;
};

/// Chooses few Gaussians with which each view loses no more than budget.error. All chunks begin with their
/// coarsest level. Then, as long as a view loses more, the step that saves the most error per Gaussian is
/// taken: a chunk gets a finer level. The choice is one for all views.
///
/// Where nothing was measured, no chunk is taken to hide another. Chunks that no view sees are refined, too,
/// if heads turn, until all of them together lose no more than budget.error on the pixels of a whole sphere;
/// each is taken to be as hidden as the seen chunks are in the mean. If heads do not turn they keep their
/// coarsest level. A chunk for which the file has no errors gets the finest level that fits.
///
/// There are more than budget.most Gaussians only if the coarsest levels have more, and there is more error
/// only where less does not fit, or needs more to be read than budget.most_new; a last thousandth of the
/// Gaussians may stay unused. To keep levels steady, errors count as a tenth larger for steps to levels no
/// finer than the chunk's in `before`, and as a tenth smaller for steps to finer ones.
LevelChoice choose_within(const std::vector<LodChunk>& chunks, const std::vector<DetailView>& views,
                          const ErrorBudget& budget, const VisibleChunks& visible = {},
                          std::span<const std::size_t> before = {});

/// A level's squared error over the area that is seen of the chunk (ChunkVisibility::area), for an eye that
/// looks `along`, a vector of any length, where a pixel covers `width` world units. Between the widths that
/// the file has, its logarithm is interpolated linearly; for wider pixels it is the error at the widest, and
/// for narrower ones it grows by a power law.
double relative_error(const LodChunk& chunk, std::size_t level, double width, const glm::dvec3& along);

/// What views lose with levels of which a few change at a time, kept up to date by the changes: a frame has
/// no time to sum up all chunks.
class RunningError {
 public:
  /// Sums up all chunks once. The choice must know errors.
  RunningError(std::shared_ptr<const LevelChoice> choice, std::vector<std::size_t> levels);
  /// From now on the chunks have these levels.
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
