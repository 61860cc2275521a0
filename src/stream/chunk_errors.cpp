#include "stream/chunk_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/parallel.h"
#include "stream/hysteresis.h"

namespace binosplat {

namespace {

/// Below the file's least pixel width, errors grow by the factor (least width / width)^growth <= max_growth.
constexpr double growth = 0.3, max_growth = 8.0;

/// A level extends beyond its chunk's visible part by this factor times the spacing of its Gaussians.
constexpr double reach = 0.5;

/// Returns a lower limit for the distance from the chunk's box to the picture's sides, world units. Returns 0
/// if the box may reach the picture or the margin from which Gaussians blur into the picture.
double distance_beside(const DetailView& view, const LodChunk& chunk, double pixel) {
  constexpr double blurred_px = 4.0;
  const glm::dvec3 to = 0.5 * (chunk.low + chunk.high) - view.eye, half = 0.5 * (chunk.high - chunk.low);
  double inside = std::numeric_limits<double>::infinity();
  for (const glm::dvec3& inward : view.inward)
    inside = std::min(inside, glm::dot(inward, to) + glm::dot(glm::abs(inward), half));
  return std::max(0.0, -inside - blurred_px * pixel);
}

/// Returns how far a level of `count` Gaussians extends beyond its chunk's visible part, world units.
double reach_of(const LodChunk& chunk, std::size_t count) {
  const double box = glm::distance(chunk.low, chunk.high);
  return reach * box / std::sqrt(static_cast<double>(std::max<std::size_t>(count, 1)));
}

/// Evaluates relative_error() for the levels of one chunk, at one pixel width and viewing direction.
class RelativeErrors {
 public:
  RelativeErrors(const LodChunk& chunk, double width, const glm::dvec3& along)
      : chunk_(chunk),
        squares_(along == glm::dvec3(0.0) ? glm::dvec3(1.0) : along * along),
        grown_(std::clamp(std::pow(chunk.pixels.front() / width, growth), 1.0, max_growth)) {
    for (glm::length_t axis = 0; axis < 3; ++axis)
      direction_[axis] = 2 * static_cast<std::size_t>(axis) + (along[axis] < 0.0 ? 1 : 0);
    const std::vector<double>& widths = chunk.pixels;
    const auto wider = std::upper_bound(widths.begin(), widths.end(), width);
    wider_ = static_cast<std::size_t>(std::min(wider, widths.end() - 1) - widths.begin());
    narrower_ = wider == widths.begin() || wider == widths.end() ? wider_ : wider_ - 1;
    if (narrower_ != wider_)
      share_ = std::log(width / widths[narrower_]) / std::log(widths[wider_] / widths[narrower_]);
    seen_ = of(chunk.seen);
  }

  double error(std::size_t level) const {
    return seen_ == 0.0 ? 0.0 : of(chunk_.levels[level].errors) / seen_ * grown_;
  }

 private:
  /// Interpolates a chunk's list: log-log by pixel width, and a mean over directions, weighted by squares_.
  double of(const std::vector<double>& list) const {
    double sum = 0.0;
    for (glm::length_t axis = 0; axis < 3; ++axis) {
      const std::size_t first = direction_[axis] * chunk_.pixels.size();
      sum += squares_[axis] * between(list[first + narrower_], list[first + wider_]);
    }
    return sum;
  }

  double between(double a, double b) const {
    if (narrower_ == wider_) return a;
    return a > 0.0 && b > 0.0 ? a * std::pow(b / a, share_) : std::lerp(a, b, share_);
  }

  const LodChunk& chunk_;
  glm::dvec3 squares_;
  std::array<std::size_t, 3> direction_{};  // index of the direction along each axis
  std::size_t narrower_ = 0, wider_ = 0;    // indices of the file's next pixel widths
  double share_ = 0.0, seen_ = 0.0, grown_;
};

/// Returns the visibility of a chunk that nothing hides.
ChunkVisibility unhidden(const LodChunk& chunk, const DetailView& view) {
  const double distance = distance_to(chunk, view.eye);
  if (chunk.pixels.empty()) return {0.0, distance};
  double area = 0.0;  // in pixels of the file's narrowest width
  for (std::size_t d = 0; d < detail_directions; ++d)
    area += chunk.seen[d * chunk.pixels.size()] / double{detail_directions};
  const double px = chunk.pixels.front() * view.focal / distance;
  return {area * px * px, distance};
}

}  // namespace

ChunkErrors::ChunkErrors(const std::vector<LodChunk>& chunks, const std::vector<DetailView>& views,
                         const VisibleChunks& visible, bool heads_turn)
    : chunks_(chunks),
      drawn_(visible.drawn),
      seen_(views.size() + 1, std::vector<ChunkInView>(chunks.size())) {
  const auto& measured = visible.by_view;
  for (const DetailView& view : views) {
    focal_.push_back(view.focal);
    eye_.push_back(view.eye);
  }
  std::vector<std::uint8_t> is_seen(chunks.size(), 0);
  std::vector<glm::dvec2> areas(chunks.size(), glm::dvec2(0.0));  // px: visible area, and area if unhidden
  const auto see = [&](std::size_t c) {
    for (std::size_t v = 0; v < views.size(); ++v) {
      const ChunkVisibility open = unhidden(chunks[c], views[v]);
      const bool was_seen = !measured.empty() && measured[v][c].area > 0.0;
      const double outside =
          was_seen ? 0.0 : distance_beside(views[v], chunks[c], open.distance / views[v].focal);
      if (outside > 0.0 &&
          (chunks[c].levels.empty() || outside > reach_of(chunks[c], chunks[c].levels.back().count)))
        continue;
      if (outside == 0.0) is_seen[c] = 1;
      ChunkInView& seen = seen_[v][c] = {open, outside};
      if (measured.empty()) continue;
      seen.area = measured[v][c].area;
      if (was_seen) seen.distance = measured[v][c].distance;
      if (outside == 0.0) areas[c] += glm::dvec2(seen.area, open.area);
    }
  };
  parallel_for(chunks.size(), see, chunks_at_once);
  double shown = 0.0, all = 0.0;
  for (const glm::dvec2& of_chunk : areas) {
    shown += of_chunk.x;
    all += of_chunk.y;
  }
  const double share = all > 0.0 ? std::min(1.0, shown / all) : 1.0;
  focal_.push_back(0.0);  // the sphere has the longest focal length
  for (const DetailView& view : views) focal_.back() = std::max(focal_.back(), view.focal);
  eye_.push_back(views.empty() ? glm::dvec3(0.0) : views.front().eye);
  if (views.empty() || !heads_turn) return;
  const auto turn = [&](std::size_t c) {
    if (is_seen[c]) return;
    ChunkInView& most = seen_.back()[c];
    for (const DetailView& view : views) {
      const ChunkVisibility open = unhidden(chunks[c], view);
      if (share * open.area > most.area) most = {{share * open.area, open.distance}, 0.0};
    }
  };
  parallel_for(chunks.size(), turn, chunks_at_once);
}

void ChunkErrors::find_errors(std::size_t view, std::size_t c, double* errors) const {
  const LodChunk& chunk = chunks_[c];
  const ChunkInView& seen = seen_[view][c];
  if (seen.distance == 0.0 || chunk.pixels.empty()) return;
  const RelativeErrors relative_errors(chunk, seen.distance / focal_[view],
                                       0.5 * (chunk.low + chunk.high) - eye_[view]);
  for (std::size_t level = 0; level < chunk.levels.size(); ++level)
    errors[level] = area(view, c, level) * relative_errors.error(level);
}

// Returns the visible area of a chunk at a level, px. If the level is coarser than the measured level, its
// Gaussians extend further, so its area is larger than the measured one. A chunk outside the picture has the
// measured area, unless the level extends into the picture.
double ChunkErrors::area(std::size_t view, std::size_t c, std::size_t level) const {
  const ChunkInView& seen = seen_[view][c];
  const LodChunk& chunk = chunks_[c];
  if (drawn_.empty() || (level <= drawn_[c] && (seen.area > 0.0 || seen.outside > 0.0))) return seen.area;
  const double out = reach_of(chunk, chunk.levels[std::max(level, drawn_[c])].count);
  if (seen.outside > out) return seen.area;
  const double side = std::sqrt(seen.area) + out * focal_[view] / seen.distance;
  return side * side;
}

double relative_error(const LodChunk& chunk, std::size_t level, double width, const glm::dvec3& along) {
  return RelativeErrors(chunk, width, along).error(level);
}

}  // namespace binosplat
