// Levels of detail by what views lose.

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>
#include <numbers>
#include <queue>
#include <tuple>
#include <utility>

#include "base/parallel.h"
#include "base/parallel_sort.h"
#include "stream/detail_parts.h"
#include "stream/detail_sights.h"

namespace binosplat {

namespace {

/// Of the Gaussians that are allowed, what is not worth looking for a step that it has room for.
constexpr std::size_t little = 1024;

/// What choose_levels_within does.
class ErrorChooser {
 public:
  ErrorChooser(const std::vector<DetailPart>& parts, const std::vector<DetailView>& views,
               const Sights& sights, double error, std::size_t most, const DetailSeen& looked_at,
               std::span<const std::size_t> before)
      : parts_(parts),
        drawn_(looked_at.drawn),
        to_come_(looked_at.to_come),
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
    parallel_for(parts.size(), find_errors, chunk_of_parts);
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
    while (loses_more_than(before_.empty() ? 1.0 : 1.0 / inertia) && has_room()) {
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
  /// Whether more is needed than may come.
  bool is_limited() const { return is_limited_ && loses_more_than(1.0); }
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
  void add_steps(std::size_t p, std::vector<Step>& steps) const {
    double most = std::numeric_limits<double>::infinity();
    for (Step step = best_step(p, chosen_[p]); step.worth > 0.0; step = best_step(p, step.level)) {
      most = step.worth = std::min(most, step.worth);
      steps.push_back(step);
    }
  }

  /// That of all parts, in the order in which they are taken: what others lose does not change it.
  std::vector<Step> steps_of_all() const {
    std::vector<Step> all;
    std::mutex adding;
    const auto add = [&](std::size_t begin, std::size_t end) {
      std::vector<Step> steps;
      for (std::size_t p = begin; p < end; ++p) add_steps(p, steps);
      const std::lock_guard lock(adding);
      all.insert(all.end(), steps.begin(), steps.end());
    };
    parallel_chunks(parts_.size(), chunk_of_parts, add);
    parallel_sort(all.begin(), all.end(), std::greater<>());
    return all;
  }

  /// Takes it if it is needed and fits; else tells which steps of the part are left.
  bool try_step(const Step& step) {
    const auto [worth, p, level] = step;
    if (!fits(p, level)) {
      finest_[p] = level + 1;  // coarser ones may be smaller
    } else if (!needed(p, level)) {
      finest_[p] = next_needed(p, level);
    } else if (!may_come(p, level)) {
      is_limited_ = true;
      finest_[p] = come_ < to_come_ - to_come_ / little ? level + 1 : std::min(drawn_[p], chosen_[p]);
    } else {
      take(p, level);
      return true;
    }
    return false;
  }

  /// Gaussians that are to come for it.
  std::size_t comes(std::size_t p, std::size_t level) const {
    return drawn_.empty() || level >= drawn_[p] ? 0 : count(p, level);
  }
  bool may_come(std::size_t p, std::size_t level) const {
    const std::size_t more = comes(p, level), others = come_ - comes(p, chosen_[p]);
    return more == 0 || others == 0 || (others <= to_come_ && more <= to_come_ - others);
  }

  /// Whether any view loses more than so many times what is allowed.
  bool loses_more_than(double times) const {
    for (std::size_t v = 0; v < allowed_.size(); ++v)
      if (lost_[v] > times * allowed_[v]) return true;
    return false;
  }
  /// For more than a little.
  bool has_room() const { return most_ > total_ && most_ - total_ > most_ / little; }

  void take(std::size_t p, std::size_t level) {
    for (std::size_t v = 0; v < lost_.size(); ++v)
      lost_[v] += error_of(v, p, level) - error_of(v, p, chosen_[p]);
    total_ = with(p, level);
    come_ = come_ - comes(p, chosen_[p]) + comes(p, level);
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
  std::span<const std::size_t> drawn_;
  std::size_t to_come_, most_;
  std::span<const std::size_t> before_;
  double sphere_pixels_;
  std::vector<double> allowed_, lost_;        // squared error, by view, the sphere's last
  std::vector<double> errors_;                // by part: by view, of each level
  std::vector<std::size_t> first_ = {0};      // of a part's
  std::vector<std::size_t> chosen_, finest_;  // the finest that may be taken
  std::size_t total_ = 0, come_ = 0;          // Gaussians
  bool is_limited_ = false;
};

}  // namespace

DetailChoice choose_levels_within(const std::vector<DetailPart>& parts, const std::vector<DetailView>& views,
                                  double error, std::size_t most, const DetailSeen& seen,
                                  std::span<const std::size_t> before, bool heads_turn) {
  ErrorChooser chooser(parts, views, Sights(parts, views, seen, heads_turn), error, most, seen, before);
  DetailChoice choice{chooser.choose(), {}, chooser.sphere_pixels(), {}, {}, chooser.is_limited()};
  for (const DetailView& view : views) choice.pixels.push_back(view.pixels);
  chooser.give_errors(choice);
  return choice;
}

double DetailChoice::error_of(std::span<const std::size_t> any_levels, std::size_t begin,
                              std::size_t end) const {
  std::vector<double> sums(end - begin, 0.0);
  for (std::size_t p = 0; p + 1 < first.size(); ++p) {
    if (levels_of(p) == 0) continue;
    for (std::size_t v = begin; v < end; ++v) sums[v - begin] += lost(v, p, any_levels[p]);
  }
  return sums.empty() ? 0.0 : *std::ranges::max_element(sums);
}

LevelsLost::LevelsLost(std::shared_ptr<const DetailChoice> choice, std::vector<std::size_t> levels)
    : choice_(std::move(choice)), levels_(std::move(levels)) {
  for (std::size_t v = 0; v < choice_->pixels.size(); ++v)
    lost_.push_back(choice_->error_of(levels_, v, v + 1));
}

void LevelsLost::follow(std::span<const std::size_t> levels) {
  for (std::size_t p = 0; p < levels_.size(); ++p) {
    if (levels_[p] == levels[p]) continue;
    for (std::size_t v = 0; v < lost_.size(); ++v)
      lost_[v] += choice_->lost(v, p, levels[p]) - choice_->lost(v, p, levels_[p]);
    levels_[p] = levels[p];
  }
}

double LevelsLost::error(std::size_t begin, std::size_t end) const {
  double most = 0.0;  // which rounding leaves less than
  for (std::size_t v = begin; v < end; ++v) most = std::max(most, lost_[v]);
  return most;
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
