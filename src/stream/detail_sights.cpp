#include "stream/detail_sights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/parallel.h"
#include "stream/detail_parts.h"

namespace binosplat {

namespace {

/// In pixels narrower than those that are known errors grow by this power of how much narrower, at most so
/// many times.
constexpr double growth = 0.3, growth_most = 8.0;

/// So many times the distance between the Gaussians of a level it reaches out from behind what hides it.
constexpr double sight_reach = 0.5;

/// How far the box lies beside the picture at least, world units; 0 where it may lie in it, or in some of the
/// pixels beside it that Gaussians are blurred to.
double distance_beside(const DetailView& view, const DetailPart& part, double pixel) {
  constexpr double blurred_px = 4.0;
  const glm::dvec3 to = 0.5 * (part.low + part.high) - view.eye, half = 0.5 * (part.high - part.low);
  double inside = std::numeric_limits<double>::infinity();
  for (const glm::dvec3& inward : view.inward)
    inside = std::min(inside, glm::dot(inward, to) + glm::dot(glm::abs(inward), half));
  return std::max(0.0, -inside - blurred_px * pixel);
}

/// How far a level of so many Gaussians reaches out of what its part shows, world units.
double reach_of(const DetailPart& part, std::size_t count) {
  const double box = glm::distance(part.low, part.high);
  return sight_reach * box / std::sqrt(static_cast<double>(std::max<std::size_t>(count, 1)));
}

/// What relative_error says of each level of one part, seen from one place.
class LookedAt {
 public:
  LookedAt(const DetailPart& part, double width, const glm::dvec3& along)
      : part_(part),
        squares_(along == glm::dvec3(0.0) ? glm::dvec3(1.0) : along * along),
        grown_(std::clamp(std::pow(part.pixels.front() / width, growth), 1.0, growth_most)) {
    for (glm::length_t axis = 0; axis < 3; ++axis)
      direction_[axis] = 2 * static_cast<std::size_t>(axis) + (along[axis] < 0.0 ? 1 : 0);
    const std::vector<double>& widths = part.pixels;
    const auto wider = std::upper_bound(widths.begin(), widths.end(), width);
    wider_ = static_cast<std::size_t>(std::min(wider, widths.end() - 1) - widths.begin());
    narrower_ = wider == widths.begin() || wider == widths.end() ? wider_ : wider_ - 1;
    if (narrower_ != wider_)
      share_ = std::log(width / widths[narrower_]) / std::log(widths[wider_] / widths[narrower_]);
    seen_ = of(part.seen);
  }

  double error(std::size_t level) const {
    return seen_ == 0.0 ? 0.0 : of(part_.levels[level].errors) / seen_ * grown_;
  }

 private:
  /// Of a list by directions and widths: its mean over directions, and between widths by lines between the
  /// logarithms.
  double of(const std::vector<double>& list) const {
    double sum = 0.0;
    for (glm::length_t axis = 0; axis < 3; ++axis) {
      const std::size_t first = direction_[axis] * part_.pixels.size();
      sum += squares_[axis] * between(list[first + narrower_], list[first + wider_]);
    }
    return sum;
  }

  double between(double a, double b) const {
    if (narrower_ == wider_) return a;
    return a > 0.0 && b > 0.0 ? a * std::pow(b / a, share_) : std::lerp(a, b, share_);
  }

  const DetailPart& part_;
  glm::dvec3 squares_;
  std::array<std::size_t, 3> direction_{};  // by axis
  std::size_t narrower_ = 0, wider_ = 0;    // of the widths that are known
  double share_ = 0.0, seen_ = 0.0, grown_;
};

/// What a view would show of a part that nothing hides.
SeenPart unhidden(const DetailPart& part, const DetailView& view) {
  const double distance = distance_to(part, view.eye);
  if (part.pixels.empty()) return {0.0, distance};
  double area = 0.0;  // in pixels of the narrowest width
  for (std::size_t d = 0; d < detail_directions; ++d)
    area += part.seen[d * part.pixels.size()] / double{detail_directions};
  const double px = part.pixels.front() * view.focal / distance;
  return {area * px * px, distance};
}

}  // namespace

Sights::Sights(const std::vector<DetailPart>& parts, const std::vector<DetailView>& views,
               const DetailSeen& looked_at, bool heads_turn)
    : parts_(parts), drawn_(looked_at.drawn), seen_(views.size() + 1, std::vector<Seen>(parts.size())) {
  const auto& found = looked_at.by_view;
  for (const DetailView& view : views) {
    focal_.push_back(view.focal);
    eye_.push_back(view.eye);
  }
  std::vector<std::uint8_t> is_seen(parts.size(), 0);
  std::vector<glm::dvec2> areas(parts.size(), glm::dvec2(0.0));  // that is shown, and that would be, px
  const auto see = [&](std::size_t p) {
    for (std::size_t v = 0; v < views.size(); ++v) {
      const SeenPart open = unhidden(parts[p], views[v]);
      const bool was_seen = !found.empty() && found[v][p].area > 0.0;
      const double outside =
          was_seen ? 0.0 : distance_beside(views[v], parts[p], open.distance / views[v].focal);
      if (outside > 0.0 &&
          (parts[p].levels.empty() || outside > reach_of(parts[p], parts[p].levels.back().count)))
        continue;
      if (outside == 0.0) is_seen[p] = 1;
      Seen& seen = seen_[v][p] = {open, outside};
      if (found.empty()) continue;
      seen.area = found[v][p].area;
      if (was_seen) seen.distance = found[v][p].distance;
      if (outside == 0.0) areas[p] += glm::dvec2(seen.area, open.area);
    }
  };
  parallel_for(parts.size(), see, chunk_of_parts);
  double shown = 0.0, all = 0.0;
  for (const glm::dvec2& of_part : areas) {
    shown += of_part.x;
    all += of_part.y;
  }
  const double share = all > 0.0 ? std::min(1.0, shown / all) : 1.0;
  focal_.push_back(0.0);  // the sphere's: the longest
  for (const DetailView& view : views) focal_.back() = std::max(focal_.back(), view.focal);
  eye_.push_back(views.empty() ? glm::dvec3(0.0) : views.front().eye);
  if (views.empty() || !heads_turn) return;
  const auto turn = [&](std::size_t p) {
    if (is_seen[p]) return;
    Seen& most = seen_.back()[p];
    for (const DetailView& view : views) {
      const SeenPart open = unhidden(parts[p], view);
      if (share * open.area > most.area) most = {{share * open.area, open.distance}, 0.0};
    }
  };
  parallel_for(parts.size(), turn, chunk_of_parts);
}

void Sights::find_errors(std::size_t view, std::size_t p, double* errors) const {
  const DetailPart& part = parts_[p];
  const Seen& seen = seen_[view][p];
  if (seen.distance == 0.0 || part.pixels.empty()) return;
  const LookedAt look(part, seen.distance / focal_[view], 0.5 * (part.low + part.high) - eye_[view]);
  for (std::size_t level = 0; level < part.levels.size(); ++level)
    errors[level] = area(view, p, level) * look.error(level);
}

// What is seen of a part at a level, px. Where a finer one was drawn, it is more; and of what lies beside the
// picture no more than was seen, but by levels that reach into it.
double Sights::area(std::size_t view, std::size_t p, std::size_t level) const {
  const Seen& seen = seen_[view][p];
  const DetailPart& part = parts_[p];
  if (drawn_.empty() || (level <= drawn_[p] && (seen.area > 0.0 || seen.outside > 0.0))) return seen.area;
  const double out = reach_of(part, part.levels[std::max(level, drawn_[p])].count);
  if (seen.outside > out) return seen.area;
  const double side = std::sqrt(seen.area) + out * focal_[view] / seen.distance;
  return side * side;
}

double relative_error(const DetailPart& part, std::size_t level, double width, const glm::dvec3& along) {
  return LookedAt(part, width, along).error(level);
}

}  // namespace binosplat
