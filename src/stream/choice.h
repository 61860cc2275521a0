#pragma once
// Choosing the level of detail of each chunk: pure functions of the chunks, of what views show of them, and
// of the allowed Gaussians and error. The same arguments give the same levels.

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
/// on an H200) than visibility passes cost (0.3 ms in the mean).
inline constexpr std::size_t few_gaussians = 1 << 19;

inline constexpr std::size_t any_number = std::numeric_limits<std::size_t>::max();

/// The request for a frame's levels.
struct DetailRequest {
  double spacing_px = 0.0;  // a chunk is fine enough if its Gaussians are at most this far apart; 0: never
  std::size_t most = any_number;       // Gaussians of the model
  std::optional<double> db = {};       // replaces spacing_px: each view's PSNR against the finest levels
  bool heads_turn = true;              // with db: also refine chunks out of view
  double calibration = 1.0;            // with db: the ratio of the loss of levels to the predicted loss
  std::size_t read_most = any_number;  // with db: Gaussians to read; one chunk always may be read
};

// Levels and frames (FrameSettings::quality) share a budget: their squared errors add up.

/// Returns the dB that levels must reach so that levels and frame together reach `together_db`: levels may
/// use half of the squared error.
double levels_target_db(double together_db);
/// Returns the dB that the frame must reach if levels reach `levels_db`: it may use the rest of the squared
/// error. That rest counts as at least a tenth of the whole.
double frame_target_db(double together_db, double levels_db);
/// Returns the PSNR of two errors together, each given by its PSNR alone, dB.
double psnr_of_both(double a_db, double b_db);
/// Convert between a squared error of colours up to 1 and its PSNR in dB.
double psnr_of_error(double squared);
double error_of_psnr(double db);

/// Returns the unit vector of direction `d` of detail_directions.
glm::dvec3 detail_direction(std::size_t d);

/// A view, in the model's frame.
struct DetailView {
  glm::dvec3 eye{0.0};
  /// Unit normals of the planes through the eye and the picture's sides, towards the picture; the last one
  /// points straight ahead. All 0: the view sees all around.
  std::array<glm::dvec3, 5> inward{};
  double focal = 1.0;   // px
  double pixels = 1.0;  // of the picture
};
std::vector<DetailView> detail_views(std::span<const shared::View> views);

/// Visibility of a chunk in a view: the sum of alpha T^2 over its Gaussians and the view's pixels, and their
/// distance, world units. One T is the transmittance before each Gaussian; the second weighs errors, which
/// are less visible behind others. The sum is small if the chunk is hidden, and 0 only if none of its
/// Gaussians is in the picture.
struct ChunkVisibility {
  double area = 0.0;  // px
  double distance = 0.0;
};

/// The result of a visibility pass, perhaps of an earlier frame; empty without one.
struct VisibleChunks {
  std::vector<std::vector<ChunkVisibility>> by_view;
  std::vector<std::size_t> drawn;  // by chunk, the level in the pass, as its index in LodChunk::levels
};

/// The level chosen for each chunk, as its index in LodChunk::levels, and the errors of all other levels.
struct LevelChoice {
  std::vector<std::size_t> levels;
  bool is_limited = false;  // more Gaussians are needed than may be read (DetailRequest::read_most)
  // Set if levels are chosen by dB:
  std::vector<double> pixels;  // of each view
  double sphere_pixels = 0.0;  // of the sphere around the views
  /// Squared errors summed over pixels, by chunk, then view (the sphere is last), then level, in one list.
  /// `first` has the index of each chunk's first error and, at its end, the length of the list.
  std::vector<double> errors;
  std::vector<std::size_t> first;

  bool has_errors() const { return !first.empty(); }
  /// Returns the error of the worst view if the chunks have these levels: squared, mean over pixels and
  /// channels.
  double error_of(std::span<const std::size_t> any_levels) const;
  double error() const { return error_of(levels); }
  /// The same for one view.
  double error_of_view(std::size_t view, std::span<const std::size_t> any_levels) const;
  /// Returns the part of it that one chunk at a level causes.
  double error_of_chunk(std::size_t view, std::size_t chunk, std::size_t level) const {
    return errors[first[chunk] + view * levels_of(chunk) + level] / pixels[view];
  }
  /// Returns the error that a chunk saves at level `to` instead of `from`, in the view (or the sphere) that
  /// gains most. It is squared, mean over pixels and channels.
  double error_saved(std::size_t chunk, std::size_t from, std::size_t to) const;

  std::size_t levels_of(std::size_t chunk) const {
    return (first[chunk + 1] - first[chunk]) / (pixels.size() + 1);
  }
};

/// Chooses levels for the views of one frame, in the model's frame: by choose_by_error() if dB are requested,
/// otherwise by choose_by_spacing() with the longest focal length. Without views it chooses the coarsest
/// levels. `before` is the previous choice.
LevelChoice choose_levels(const std::vector<LodChunk>& chunks, std::span<const shared::View> views,
                          const DetailRequest& request, const VisibleChunks& visible = {},
                          std::span<const std::size_t> before = {});

/// Chooses levels by the spacing of Gaussians. All chunks begin with their coarsest level. While there is
/// room, the chunk with the largest spacing for its nearest eye gets its next finer level. The spacing in
/// radians is the box's diagonal, divided by the root of the count of Gaussians and by the distance. A chunk
/// whose spacing is at most `spacing_wanted` stays as it is. The choice is shared by all eyes. It exceeds
/// `most` Gaussians only if the coarsest levels do. Hysteresis keeps levels steady. Spacings count as a tenth
/// larger for steps to levels no finer than the chunk's in `before` (a choice for the same chunks). For steps
/// to finer levels they count as a tenth smaller.
std::vector<std::size_t> choose_by_spacing(const std::vector<LodChunk>& chunks,
                                           const std::vector<glm::dvec3>& eyes, std::size_t most,
                                           double spacing_wanted = 0.0,
                                           std::span<const std::size_t> before = {});

struct ErrorBudget {
  double error = 0.0;  // allowed in each view: squared, mean over pixels and channels
  // As in DetailRequest:
  std::size_t most = any_number;
  bool heads_turn = true;
  std::size_t read_most = any_number;
};

/// Chooses few Gaussians such that no view loses more than budget.error. All chunks begin with their coarsest
/// level. While a view loses more, it takes the step to a finer level that saves the most error per Gaussian.
/// The choice is shared by all views.
///
/// Without a measurement, no chunk is assumed to hide another. If heads turn, unseen chunks are refined, too,
/// until together they lose at most budget.error on the pixels of a whole sphere. Each is assumed to be as
/// hidden as seen chunks are in the mean. If heads do not turn, unseen chunks keep their coarsest level. A
/// chunk without errors in the file gets the finest level that fits.
///
/// The choice exceeds budget.most Gaussians only if the coarsest levels do. It exceeds the error only if less
/// does not fit, or if more than budget.read_most must be read; the last thousandth of the Gaussians may stay
/// unused. Hysteresis keeps levels steady. Errors count as a tenth larger for steps to levels no finer than
/// the chunk's in `before`. For steps to finer levels they count as a tenth smaller.
LevelChoice choose_by_error(const std::vector<LodChunk>& chunks, const std::vector<DetailView>& views,
                            const ErrorBudget& budget, const VisibleChunks& visible = {},
                            std::span<const std::size_t> before = {});

/// Returns the ratio of a level's squared error to the visible area of its chunk (ChunkVisibility::area). The
/// eye looks `along` a vector of any length, and a pixel covers `width` world units. Between the file's
/// widths, logarithms are interpolated linearly. Wider pixels use the error at the widest; for narrower
/// pixels the error grows by a power law.
double relative_error(const LodChunk& chunk, std::size_t level, double width, const glm::dvec3& along);

/// The error of views while a few levels change at a time. It is updated by the changes, since a frame has no
/// time to sum over all chunks.
class RunningError {
 public:
  /// Sums over all chunks once. The choice must know errors.
  RunningError(std::shared_ptr<const LevelChoice> choice, std::vector<std::size_t> levels);
  /// Sets the chunks' levels.
  void follow(std::span<const std::size_t> levels);
  /// Returns the error of the worst view of [begin, end) (LevelChoice::error_of), up to rounding.
  double error(std::size_t begin, std::size_t end) const;
  std::size_t views() const { return lost_.size(); }

 private:
  std::shared_ptr<const LevelChoice> choice_;
  std::vector<std::size_t> levels_;
  std::vector<double> lost_;  // by view
};

}  // namespace binosplat
