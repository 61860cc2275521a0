// Levels of detail by what views lose.

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <mutex>
#include <numbers>
#include <queue>
#include <tuple>
#include <utility>

#include "base/parallel.h"
#include "formats/detail_parts.h"

namespace binosplat {

namespace {

/// In pixels narrower than those that are known errors grow by this power of how much narrower, at most so
/// many times.
constexpr double growth = 0.3, growth_most = 8.0;

constexpr std::size_t chunk = 256;  // parts that are worth a thread's while

/// Of the Gaussians that are allowed, what is not worth looking for a step that it has room for.
constexpr std::size_t little = 1024;

/// So many times the distance between the Gaussians of a level it reaches out from behind what hides it.
constexpr double reach = 0.5;

/// Whether the box, and some of the pixels beside it that Gaussians are blurred to, may lie in the picture.
bool sees(const DetailView& view, const DetailPart& part, double pixel) {
  constexpr double blurred_px = 4.0;
  const glm::dvec3 to = 0.5 * (part.low + part.high) - view.eye, half = 0.5 * (part.high - part.low);
  return std::ranges::all_of(view.inward, [&](const glm::dvec3& inward) {
    return glm::dot(inward, to) + glm::dot(glm::abs(inward), half) >= -blurred_px * pixel;
  });
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

/// What is seen of all parts by each view, and by the sphere around them, which comes last and sees what
/// none of them does.
class Sights {
 public:
  Sights(const std::vector<DetailPart>& parts, const std::vector<DetailView>& views,
         const DetailSeen& looked_at, bool heads_turn)
      : parts_(parts), drawn_(looked_at.drawn), seen_(views.size() + 1, std::vector<SeenPart>(parts.size())) {
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
        if (!was_seen && !sees(views[v], parts[p], open.distance / views[v].focal)) continue;
        is_seen[p] = 1;
        SeenPart& seen = seen_[v][p] = open;
        if (found.empty()) continue;
        seen.area = found[v][p].area;
        if (was_seen) seen.distance = found[v][p].distance;
        areas[p] += glm::dvec2(seen.area, open.area);
      }
    };
    parallel_for(parts.size(), see, chunk);
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
      SeenPart& most = seen_.back()[p];
      for (const DetailView& view : views) {
        const SeenPart open = unhidden(parts[p], view);
        if (share * open.area > most.area) most = {share * open.area, open.distance};
      }
    };
    parallel_for(parts.size(), turn, chunk);
  }

  /// Squared error of each level of a part, summed over px; left as it is where it is none.
  void find_errors(std::size_t view, std::size_t p, double* errors) const {
    const DetailPart& part = parts_[p];
    const SeenPart& seen = seen_[view][p];
    if (seen.distance == 0.0 || part.pixels.empty()) return;
    const LookedAt look(part, seen.distance / focal_[view], 0.5 * (part.low + part.high) - eye_[view]);
    for (std::size_t level = 0; level < part.levels.size(); ++level)
      errors[level] = area(view, p, level) * look.error(level);
  }

  double longest_focal() const { return focal_.back(); }

 private:
  /// What is seen of a part at a level, px. Where a finer one was drawn, it is more.
  double area(std::size_t view, std::size_t p, std::size_t level) const {
    const SeenPart& seen = seen_[view][p];
    const DetailPart& part = parts_[p];
    if (drawn_.empty() || (level <= drawn_[p] && seen.area > 0.0)) return seen.area;
    const std::size_t count = part.levels[std::max(level, drawn_[p])].count;
    const double apart =
        glm::distance(part.low, part.high) / std::sqrt(static_cast<double>(std::max<std::size_t>(count, 1)));
    const double side = std::sqrt(seen.area) + reach * apart * focal_[view] / seen.distance;
    return side * side;
  }

  const std::vector<DetailPart>& parts_;
  std::span<const std::size_t> drawn_;
  std::vector<double> focal_;
  std::vector<glm::dvec3> eye_;
  std::vector<std::vector<SeenPart>> seen_;
};

/// What choose_levels_within does.
class ErrorChooser {
 public:
  ErrorChooser(const std::vector<DetailPart>& parts, const std::vector<DetailView>& views,
               const Sights& sights, double error, std::size_t most, std::span<const std::size_t> before)
      : parts_(parts),
        most_(most),
        before_(before),
        sphere_pixels_(4.0 * std::numbers::pi * sights.longest_focal() * sights.longest_focal()),
        chosen_(parts.size(), 0),
        finest_(parts.size(), 0) {
    for (const DetailView& view : views) allowed_.push_back(error * view.pixels);
    allowed_.push_back(error * sphere_pixels_);
    lost_.resize(allowed_.size());
    for (const DetailPart& part : parts)
      first_.push_back(first_.back() + allowed_.size() * part.levels.size());
    errors_.resize(first_.back());
    const auto find_errors = [&](std::size_t p) {
      for (std::size_t v = 0; v < allowed_.size(); ++v)
        sights.find_errors(v, p, errors_.data() + first_[p] + v * parts[p].levels.size());
    };
    parallel_for(parts.size(), find_errors, chunk);
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (parts[p].levels.empty()) continue;
      chosen_[p] = parts[p].levels.size() - 1;
      total_ += parts[p].levels.back().count;
      for (std::size_t v = 0; v < lost_.size(); ++v) lost_[v] += error_of(v, p, chosen_[p]);
    }
  }

  std::vector<std::size_t> choose() {
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      for (std::size_t level = 0; parts_[p].pixels.empty() && level < chosen_[p]; ++level) {
        if (fits(p, level)) take(p, level);
      }
    }
    const std::vector<Step> steps = steps_of_all();
    std::vector<bool> left(parts_.size(), false);  // its steps: one was refused
    std::priority_queue<Step> others;              // of such parts
    auto next = steps.begin();
    while (is_needed() && has_room()) {
      while (next != steps.end() && left[next->part]) ++next;
      const bool in_order = next != steps.end() && (others.empty() || others.top() < *next);
      if (!in_order && others.empty()) break;
      const Step step = in_order ? *next++ : others.top();
      if (!in_order) others.pop();
      if (try_step(step) && in_order) continue;
      left[step.part] = true;
      if (const Step other = best_step(step.part); other.worth > 0.0) others.push(other);
    }
    return chosen_;
  }

  double sphere_pixels() const { return sphere_pixels_; }
  void give_errors(DetailChoice& choice) {
    choice.errors = std::move(errors_);
    choice.first = std::move(first_);
  }

 private:
  struct Step {
    double worth = 0.0;  // error saved per Gaussian
    std::size_t part = 0, level = 0;
    bool operator<(const Step& other) const {
      return std::tuple(worth, other.part, level) < std::tuple(other.worth, part, other.level);
    }
    bool operator>(const Step& other) const { return other < *this; }
  };

  std::size_t count(std::size_t p, std::size_t level) const { return parts_[p].levels[level].count; }
  std::size_t with(std::size_t p, std::size_t level) const {
    return total_ - count(p, chosen_[p]) + count(p, level);
  }
  bool fits(std::size_t p, std::size_t level) const { return with(p, level) <= most_; }
  double error_of(std::size_t view, std::size_t p, std::size_t level) const {
    return errors_[first_[p] + view * parts_[p].levels.size() + level];
  }

  /// What a part does by itself, as long as nothing is refused; worth no more than what comes before.
  std::vector<Step> steps_of(std::size_t p) const {
    std::vector<Step> steps;
    double most = std::numeric_limits<double>::infinity();
    for (Step step = best_step(p, chosen_[p]); step.worth > 0.0; step = best_step(p, step.level)) {
      most = step.worth = std::min(most, step.worth);
      steps.push_back(step);
    }
    return steps;
  }

  /// That of all parts, in the order in which they are taken: what others lose does not change it.
  std::vector<Step> steps_of_all() const {
    std::vector<Step> all;
    std::mutex adding;
    const auto add = [&](std::size_t begin, std::size_t end) {
      std::vector<Step> steps;
      for (std::size_t p = begin; p < end; ++p) std::ranges::copy(steps_of(p), std::back_inserter(steps));
      const std::lock_guard lock(adding);
      all.insert(all.end(), steps.begin(), steps.end());
    };
    parallel_chunks(parts_.size(), chunk, add);
    tbb::parallel_sort(all.begin(), all.end(), std::greater<>());
    return all;
  }

  /// Takes it if it is needed and fits; else tells which steps of the part are left.
  bool try_step(const Step& step) {
    const auto [worth, p, level] = step;
    if (!fits(p, level)) {
      finest_[p] = level + 1;  // coarser ones may be smaller
    } else if (!needed(p, level)) {
      finest_[p] = next_needed(p, level);
    } else {
      take(p, level);
      return true;
    }
    return false;
  }

  /// Whether any view loses too much.
  bool is_needed() const {
    for (std::size_t v = 0; v < allowed_.size(); ++v)
      if (lost_[v] * (before_.empty() ? 1.0 : inertia) > allowed_[v]) return true;
    return false;
  }
  /// For more than a little.
  bool has_room() const { return most_ > total_ && most_ - total_ > most_ / little; }

  void take(std::size_t p, std::size_t level) {
    for (std::size_t v = 0; v < lost_.size(); ++v)
      lost_[v] += error_of(v, p, level) - error_of(v, p, chosen_[p]);
    total_ = with(p, level);
    chosen_[p] = level;
  }

  /// Whether a view that sees the part loses too much; any, where none sees it.
  bool needed(std::size_t p, std::size_t level) const {
    const bool is_seen = error_of(allowed_.size() - 1, p, chosen_[p]) == 0.0;
    for (std::size_t v = 0; v < allowed_.size(); ++v) {
      if (is_seen && error_of(v, p, chosen_[p]) == 0.0) continue;
      if (lost_[v] * inertia_of(before_, p, level) > allowed_[v]) return true;
    }
    return false;
  }

  /// The finest level that may be needed where this one is not: that of before counts more.
  std::size_t next_needed(std::size_t p, std::size_t level) const {
    return before_.empty() || level >= before_[p] ? chosen_[p] : before_[p];
  }

  /// That of a part which saves the most error per Gaussian; worth nothing where none does.
  Step best_step(std::size_t p) const { return best_step(p, chosen_[p]); }
  Step best_step(std::size_t p, std::size_t from) const {
    Step best{0.0, p, 0};
    for (std::size_t level = from; level-- > finest_[p];) {
      double saved = 0.0;
      for (std::size_t v = 0; v < lost_.size(); ++v)
        saved = std::max(saved, error_of(v, p, from) - error_of(v, p, level));
      const double added = static_cast<double>(count(p, level)) - static_cast<double>(count(p, from));
      const double worth = inertia_of(before_, p, level) * saved / std::max(added, 1.0);
      if (worth > best.worth) best = {worth, p, level};
    }
    return best;
  }

  const std::vector<DetailPart>& parts_;
  std::size_t most_;
  std::span<const std::size_t> before_;
  double sphere_pixels_;
  std::vector<double> allowed_, lost_;        // squared error, by view, the sphere's last
  std::vector<double> errors_;                // by part: by view, of each level
  std::vector<std::size_t> first_ = {0};      // of a part's
  std::vector<std::size_t> chosen_, finest_;  // the finest that may be taken
  std::size_t total_ = 0;
};

}  // namespace

double relative_error(const DetailPart& part, std::size_t level, double width, const glm::dvec3& along) {
  return LookedAt(part, width, along).error(level);
}

DetailChoice choose_levels_within(const std::vector<DetailPart>& parts, const std::vector<DetailView>& views,
                                  double error, std::size_t most, const DetailSeen& seen,
                                  std::span<const std::size_t> before, bool heads_turn) {
  ErrorChooser chooser(parts, views, Sights(parts, views, seen, heads_turn), error, most, before);
  DetailChoice choice{chooser.choose(), {}, chooser.sphere_pixels(), {}, {}};
  for (const DetailView& view : views) choice.pixels.push_back(view.pixels);
  chooser.give_errors(choice);
  return choice;
}

double DetailChoice::error_of(std::span<const std::size_t> any_levels, std::size_t begin,
                              std::size_t end) const {
  std::vector<double> lost(end - begin, 0.0);
  for (std::size_t p = 0; p + 1 < first.size(); ++p) {
    const std::size_t levels_of_part = levels_of(p);
    for (std::size_t v = begin; levels_of_part > 0 && v < end; ++v)
      lost[v - begin] += errors[first[p] + v * levels_of_part + any_levels[p]] / pixels[v];
  }
  return lost.empty() ? 0.0 : *std::ranges::max_element(lost);
}

double DetailChoice::saved(std::size_t part, std::size_t from, std::size_t to) const {
  const std::size_t levels_of_part = levels_of(part);
  double most = 0.0;
  for (std::size_t v = 0; v <= pixels.size(); ++v) {
    const double* const of_view = errors.data() + first[part] + v * levels_of_part;
    most = std::max(most, (of_view[from] - of_view[to]) / (v < pixels.size() ? pixels[v] : sphere_pixels));
  }
  return most;
}

}  // namespace binosplat
