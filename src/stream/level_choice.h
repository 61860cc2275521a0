#pragma once
// Chooses the level of detail of each chunk. The functions are pure.

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "formats/models/sog_levels.h"
#include "shared/types.h"

namespace binosplat {

/// With up to this many Gaussians, visibility passes take longer than coarser levels save (README.md).
inline constexpr std::size_t few_gaussians = 1 << 19;

inline constexpr std::size_t any_number = std::numeric_limits<std::size_t>::max();

/// The request for a frame's levels.
struct DetailRequest {
  /// A chunk is fine enough if its Gaussians are at most this far apart. With 0 no chunk is fine enough.
  double spacing_px = 0.0;
  std::size_t max_gaussians = any_number;  // maximum number of Gaussians in the model
  std::optional<double> db = {};  // least PSNR of each view against the finest levels; replaces spacing_px
  // With db only:
  bool heads_turn = true;             // whether chunks out of view are refined, too
  double loss_correction = 1.0;       // expected loss of levels / predicted loss
  std::size_t max_read = any_number;  // maximum number of Gaussians to read; one chunk is always allowed
};

// Levels and frames (FrameSettings::quality) share a budget: their squared errors add up.

/// Returns the dB that levels must reach for `together_db`: levels may use half of the squared error.
double levels_target_db(double together_db);
/// Returns the dB that the frame must reach if levels reach `levels_db`. The frame may use the rest of the
/// squared error, and in any case a tenth of the whole.
double frame_target_db(double together_db, double levels_db);
/// Returns the PSNR in dB of two errors that add up, given the PSNR of each.
double psnr_of_both(double a_db, double b_db);
/// Convert between a squared error of colours up to 1 and its PSNR in dB.
double psnr_of_error(double squared);
double error_of_psnr(double db);

/// Returns the unit vector of direction `d`, 0 to detail_directions - 1.
glm::dvec3 detail_direction(std::size_t d);

/// A view, in the model's coordinates.
struct DetailView {
  glm::dvec3 eye{0.0};
  /// Four unit normals, then the viewing direction. Each normal is that of a plane through the eye and a side
  /// of the picture, and points to the picture. If all are 0, the view sees all directions.
  std::array<glm::dvec3, 5> inward{};
  double focal = 1.0;   // px
  double pixels = 1.0;  // number of pixels in the picture
};
std::vector<DetailView> detail_views(std::span<const shared::View> views);

/// Visibility of a chunk in a view. `area` is the sum of alpha T^2 over the chunk's Gaussians and the view's
/// pixels. alpha T is a Gaussian's weight in a pixel; the second T gives less weight to errors behind other
/// Gaussians. `area` is small if the chunk is hidden, and 0 only if none of its Gaussians is in the picture.
struct ChunkVisibility {
  double area = 0.0;      // px
  double distance = 0.0;  // mean distance of the Gaussians from the eye, world units
};

/// The result of a visibility pass, perhaps of an earlier frame. Both lists are empty if there was no pass.
struct VisibleChunks {
  std::vector<std::vector<ChunkVisibility>> by_view;
  std::vector<std::size_t> drawn;  // by chunk: the level in the pass, an index of LodChunk::levels
};

/// The level chosen for each chunk, an index of LodChunk::levels, and the errors of all levels.
struct LevelChoice {
  std::vector<std::size_t> levels;
  bool is_limited = false;  // the views need more Gaussians than may be read (DetailRequest::max_read)
  // Set if levels are chosen by dB:
  std::vector<double> pixels;  // number of pixels of each view
  double sphere_pixels = 0.0;  // number of pixels of the sphere around the views
  /// Squared errors, summed over pixels, in one list: by chunk, then by view (the sphere is last), then by
  /// level. `first` has the index of each chunk's first error and, at its end, the length of the list.
  std::vector<double> errors;
  std::vector<std::size_t> first;

  bool has_errors() const { return !first.empty(); }
  /// Returns the worst view's error for these levels: squared, mean over pixels and channels.
  double error_of(std::span<const std::size_t> any_levels) const;
  double error() const { return error_of(levels); }
  /// Returns the error of one view, as error_of() does.
  double error_of_view(std::size_t view, std::span<const std::size_t> any_levels) const;
  /// Returns the part of a view's error that one chunk at a level causes.
  double error_of_chunk(std::size_t view, std::size_t chunk, std::size_t level) const {
    return errors[first[chunk] + view * levels_of(chunk) + level] / pixels[view];
  }
  /// Returns how much less error a chunk has at level `to` than at level `from`, in the view (or the sphere)
  /// that gains most. The error is squared, mean over pixels and channels.
  double error_saved(std::size_t chunk, std::size_t from, std::size_t to) const;

  std::size_t levels_of(std::size_t chunk) const {
    return (first[chunk + 1] - first[chunk]) / (pixels.size() + 1);
  }
};

/// Chooses levels for the views of one frame, in the model's coordinates. If dB are requested, it calls
/// choose_by_error(), otherwise choose_by_spacing() with the longest focal length. Without views it chooses
/// the coarsest levels. `before` is the previous choice.
LevelChoice choose_levels(const std::vector<LodChunk>& chunks, std::span<const shared::View> views,
                          const DetailRequest& request, const VisibleChunks& visible = {},
                          std::span<const std::size_t> before = {});

/// Chooses levels by the spacing of Gaussians; all eyes share the levels. All chunks begin with their
/// coarsest level. While there is room and the largest spacing exceeds `spacing_wanted`, the chunk with this
/// spacing gets its next finer level. A chunk's spacing, in radians, is the diagonal of its box, divided by
/// the root of its number of Gaussians and by the distance from the nearest eye. The choice exceeds `most`
/// Gaussians only if the coarsest levels do. `before`, the previous choice, keeps levels steady: it scales
/// spacings (inertia_of).
std::vector<std::size_t> choose_by_spacing(const std::vector<LodChunk>& chunks,
                                           const std::vector<glm::dvec3>& eyes, std::size_t max_gaussians,
                                           double spacing_wanted = 0.0,
                                           std::span<const std::size_t> before = {});

struct ErrorBudget {
  double error = 0.0;  // maximum in each view: squared, mean over pixels and channels
  // As in DetailRequest:
  std::size_t max_gaussians = any_number;
  bool heads_turn = true;
  std::size_t max_read = any_number;
};

/// Chooses few Gaussians such that no view loses more than budget.error; all views share the levels. All
/// chunks begin with their coarsest level. While a view loses more, the chunk whose finer level saves the
/// most error per added Gaussian gets this level.
///
/// If `visible` is empty, no chunk is assumed to hide another. If heads turn, unseen chunks are refined, too,
/// until together they lose at most budget.error on the pixels of a whole sphere. Each unseen chunk is
/// assumed to be as hidden as the mean of the seen chunks. If heads do not turn, unseen chunks keep their
/// coarsest level. A chunk without errors in the file gets the finest level that fits.
///
/// The choice exceeds budget.max_gaussians Gaussians only if the coarsest levels do. It exceeds budget.error
/// only if finer levels do not fit or need more than budget.max_read Gaussians to be read. The last
/// thousandth of the allowed Gaussians may stay unused. Hysteresis keeps levels steady (inertia_of). `before`
/// is the previous choice: if a level is finer than the chunk's level in `before`, the error is divided
/// by 1.1, otherwise multiplied.
LevelChoice choose_by_error(const std::vector<LodChunk>& chunks, const std::vector<DetailView>& views,
                            const ErrorBudget& budget, const VisibleChunks& visible = {},
                            std::span<const std::size_t> before = {});

/// Returns the ratio of a level's squared error to the visible area of its chunk (ChunkVisibility::area).
/// `along` is the viewing direction, of any length. At the chunk a pixel is `width` world units wide. Between
/// the file's pixel widths, the logarithms of error and width are interpolated linearly. Pixels wider than
/// these have the error of the widest. In narrower pixels the error grows by a power law.
double relative_error(const LodChunk& chunk, std::size_t level, double width, const glm::dvec3& along);

/// The errors of views while levels change. Each change updates the sums: summing over all chunks is slow.
class RunningError {
 public:
  /// Sums over all chunks. The choice must have errors (LevelChoice::has_errors).
  RunningError(std::shared_ptr<const LevelChoice> choice, std::vector<std::size_t> levels);
  void follow(std::span<const std::size_t> levels);
  /// Returns the error of the worst view in [begin, end), as LevelChoice::error_of() does, up to rounding.
  double error(std::size_t begin, std::size_t end) const;
  std::size_t views() const { return lost_.size(); }

 private:
  std::shared_ptr<const LevelChoice> choice_;
  std::vector<std::size_t> levels_;
  std::vector<double> lost_;  // error of each view
};

}  // namespace binosplat
