#include "formats/detail.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>

namespace binosplat {

namespace {

/// By how much a level must be too coarse, or finer than need be, before it is left: heads are never still.
constexpr double inertia = 1.1;

/// By how much more a level is needed that is not finer than the one before, and by how much less one that
/// is.
double inertia_of(std::span<const std::size_t> before, std::size_t part, std::size_t level) {
  if (before.empty()) return 1.0;
  return level < before[part] ? 1.0 / inertia : inertia;
}

/// From an eye to the box, at least a hundredth of its diagonal: 0 within it would hide how coarse its
/// Gaussians are.
double distance_to(const DetailPart& part, const glm::dvec3& eye) {
  return std::max(glm::distance(eye, glm::clamp(eye, part.low, part.high)),
                  0.01 * glm::distance(part.low, part.high));
}

/// From the nearest eye; 1 without eyes.
double distance_to(const DetailPart& part, const std::vector<glm::dvec3>& eyes) {
  if (eyes.empty()) return 1.0;
  double nearest = INFINITY;
  for (const glm::dvec3& eye : eyes) nearest = std::min(nearest, distance_to(part, eye));
  return nearest;
}

/// Whether the ball around the box, and around some of the pixels beside it that Gaussians are blurred to,
/// meets the cone around the picture.
bool sees(const DetailView& view, const DetailPart& part, double pixel) {
  constexpr double blurred_px = 4.0;
  const glm::dvec3 to = 0.5 * (part.low + part.high) - view.eye;
  const double ahead = glm::dot(to, view.forward);
  const double aside = std::sqrt(std::max(0.0, glm::dot(to, to) - ahead * ahead));
  const double cosine = 1.0 / std::hypot(1.0, view.slope), sine = view.slope * cosine;
  const bool eye_is_nearest = ahead * cosine + aside * sine < 0.0;
  const double away = eye_is_nearest ? glm::length(to) : aside * cosine - ahead * sine;
  return away <= 0.5 * glm::distance(part.low, part.high) + blurred_px * pixel;
}

/// A part as the views see it.
struct Seen {
  std::vector<std::size_t> by;  // views; the sphere around them, whose number follows theirs, if none does
  std::vector<double> errors;   // of its levels; 0 where they are not known
};

Seen seen(const DetailPart& part, const std::vector<DetailView>& views) {
  Seen result;
  double width = INFINITY, unseen = INFINITY;  // of a pixel at the part
  for (std::size_t v = 0; v < views.size(); ++v) {
    const double here = distance_to(part, views[v].eye) / views[v].focal;
    unseen = std::min(unseen, here);
    if (!sees(views[v], part, here)) continue;
    width = std::min(width, here);
    result.by.push_back(v);
  }
  if (result.by.empty()) {
    result.by = {views.size()};
    width = unseen;
  }
  for (std::size_t level = 0; level < part.levels.size(); ++level)
    result.errors.push_back(part.pixel > 0.0 ? squared_error(part, level, width) : 0.0);
  return result;
}

/// What choose_levels_within does.
class ErrorChooser {
 public:
  ErrorChooser(const std::vector<DetailPart>& parts, const std::vector<DetailView>& views, double error,
               std::size_t most, std::span<const std::size_t> before)
      : parts_(parts), most_(most), before_(before), chosen_(parts.size(), 0), finest_(parts.size(), 0) {
    double focal = 0.0;
    for (const DetailView& view : views) {
      focal = std::max(focal, view.focal);
      allowed_.push_back(error * view.pixels);
    }
    allowed_.push_back(error * 4.0 * std::numbers::pi * focal * focal);
    for (std::size_t p = 0; p < parts.size(); ++p) {
      seen_.push_back(seen(parts[p], views));
      if (parts[p].levels.empty()) continue;
      chosen_[p] = parts[p].levels.size() - 1;
      total_ += parts[p].levels.back().count;
    }
  }

  std::vector<std::size_t> choose() {
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      for (std::size_t level = 0; parts_[p].pixel == 0.0 && level < chosen_[p]; ++level) {
        if (fits(p, level)) take(p, level);
      }
    }
    lost_ = lost();
    std::priority_queue<Step> steps;
    for (std::size_t p = 0; p < parts_.size(); ++p) add(steps, p);
    while (!steps.empty()) {
      const auto [worth, p, level] = steps.top();
      steps.pop();
      if (fits(p, level) && needed(p, level)) {
        for (const std::size_t v : seen_[p].by)
          lost_[v] += seen_[p].errors[level] - seen_[p].errors[chosen_[p]];
        take(p, level);
      } else {
        finest_[p] = level + 1;  // coarser ones may be smaller, or needed more by what was before
      }
      add(steps, p);
    }
    return chosen_;
  }

  /// By view, the sphere's last.
  std::vector<double> lost() const {
    std::vector<double> sums(allowed_.size(), 0.0);
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      if (parts_[p].levels.empty()) continue;
      for (const std::size_t v : seen_[p].by) sums[v] += seen_[p].errors[chosen_[p]];
    }
    return sums;
  }

 private:
  struct Step {
    double worth;  // error saved per Gaussian
    std::size_t part, level;
    bool operator<(const Step& other) const { return worth < other.worth; }
  };

  std::size_t count(std::size_t p, std::size_t level) const { return parts_[p].levels[level].count; }
  std::size_t with(std::size_t p, std::size_t level) const {
    return total_ - count(p, chosen_[p]) + count(p, level);
  }
  bool fits(std::size_t p, std::size_t level) const { return with(p, level) <= most_; }

  void take(std::size_t p, std::size_t level) {
    total_ = with(p, level);
    chosen_[p] = level;
  }

  /// Whether a view that sees the part loses too much; any, where none sees it.
  bool needed(std::size_t p, std::size_t level) const {
    const auto too_much = [&](std::size_t v) {
      return lost_[v] * inertia_of(before_, p, level) > allowed_[v];
    };
    const std::vector<std::size_t>& by = seen_[p].by;
    if (by.front() + 1 < allowed_.size()) return std::any_of(by.begin(), by.end(), too_much);
    for (std::size_t v = 0; v < allowed_.size(); ++v) {
      if (too_much(v)) return true;
    }
    return false;
  }

  /// The step of a part that saves the most error per Gaussian.
  void add(std::priority_queue<Step>& steps, std::size_t p) const {
    Step best{0.0, p, 0};
    for (std::size_t level = chosen_[p]; level-- > finest_[p];) {
      const double saved = seen_[p].errors[chosen_[p]] - seen_[p].errors[level];
      const double added = static_cast<double>(count(p, level)) - static_cast<double>(count(p, chosen_[p]));
      const double worth = inertia_of(before_, p, level) * saved / std::max(added, 1.0);
      if (worth > best.worth) best = {worth, p, level};
    }
    if (best.worth > 0.0) steps.push(best);
  }

  const std::vector<DetailPart>& parts_;
  std::size_t most_;
  std::span<const std::size_t> before_;
  std::vector<double> allowed_, lost_;  // squared error, by view
  std::vector<Seen> seen_;
  std::vector<std::size_t> chosen_, finest_;  // the finest that may be taken
  std::size_t total_ = 0;
};

}  // namespace

std::vector<std::size_t> choose_levels(const std::vector<DetailPart>& parts,
                                       const std::vector<glm::dvec3>& eyes, std::size_t most, double enough,
                                       std::span<const std::size_t> before) {
  struct Coarse {
    double apart;  // of its Gaussians, as seen, radians
    std::size_t part;
    bool operator<(const Coarse& other) const { return apart < other.apart; }
  };
  std::vector<std::size_t> chosen(parts.size(), 0);
  std::priority_queue<Coarse> coarse;
  std::size_t total = 0;
  const auto add = [&](std::size_t p) {
    const DetailPart& part = parts[p];
    if (chosen[p] == 0) return;  // the finest
    const auto count = static_cast<double>(std::max<std::size_t>(part.levels[chosen[p]].count, 1));
    const double diagonal = glm::distance(part.low, part.high);
    const double stays = inertia_of(before, p, chosen[p] - 1);
    const double apart = stays * diagonal / std::sqrt(count) / distance_to(part, eyes);
    if (apart > enough) coarse.push({apart, p});
  };
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (parts[p].levels.empty()) continue;
    chosen[p] = parts[p].levels.size() - 1;
    total += parts[p].levels.back().count;
    add(p);
  }
  while (!coarse.empty()) {
    const std::size_t p = coarse.top().part;
    coarse.pop();
    const std::size_t now = parts[p].levels[chosen[p]].count, finer = parts[p].levels[chosen[p] - 1].count;
    if (total - now + finer > most) continue;  // others may be smaller
    total = total - now + finer;
    --chosen[p];
    add(p);
  }
  return chosen;
}

double squared_error(const DetailPart& part, std::size_t level, double width) {
  const std::vector<double>& errors = part.levels[level].errors;
  // Where it lies among the errors; 2^50 times beyond them is far enough for a part without extent.
  const double last = static_cast<double>(errors.size() - 1);
  const double place = std::clamp(std::log2(width / part.pixel), -50.0, last + 50.0);
  if (place <= 0.0) return errors.front() * std::exp2(-2.0 * place);
  if (place >= last) return errors.back() * std::exp2(2.0 * (last - place));
  const auto before = static_cast<std::size_t>(place);
  const double a = errors[before], b = errors[before + 1], share = place - std::floor(place);
  if (a > 0.0 && b > 0.0) return std::exp2(std::lerp(std::log2(a), std::log2(b), share));
  return std::lerp(a, b, share);
}

DetailChoice choose_levels_within(const std::vector<DetailPart>& parts, const std::vector<DetailView>& views,
                                  double error, std::size_t most, std::span<const std::size_t> before) {
  ErrorChooser chooser(parts, views, error, most, before);
  DetailChoice result{chooser.choose()};
  const std::vector<double> lost = chooser.lost();
  for (std::size_t v = 0; v < views.size(); ++v)
    result.error = std::max(result.error, lost[v] / views[v].pixels);
  return result;
}

}  // namespace binosplat
