// Chooses levels of detail by the error of views.

#include <algorithm>
#include <functional>
#include <limits>
#include <mutex>
#include <numbers>
#include <queue>
#include <tuple>
#include <utility>

#include "base/parallel.h"
#include "base/parallel_sort.h"
#include "stream/chunk_errors.h"
#include "stream/hysteresis.h"

namespace binosplat {

namespace {

/// A search for a step that fits pays only if at least 1 / `min_free_divisor` of the allowed Gaussians is
/// left.
constexpr std::size_t min_free_divisor = 1024;

class ErrorChooser {
 public:
  ErrorChooser(const std::vector<LodChunk>& chunks, const std::vector<DetailView>& views,
               const ErrorBudget& budget, const VisibleChunks& visible, std::span<const std::size_t> before)
      : chunks_(chunks),
        drawn_(visible.drawn),
        max_read_(budget.max_read),
        max_gaussians_(budget.max_gaussians),
        before_(before),
        chosen_(chunks.size(), 0),
        finest_(chunks.size(), 0) {
    const ChunkErrors errors(chunks, views, visible, budget.heads_turn);
    sphere_pixels_ = 4.0 * std::numbers::pi * errors.longest_focal() * errors.longest_focal();
    for (const DetailView& view : views) allowed_.push_back(budget.error * view.pixels);
    allowed_.push_back(budget.error * sphere_pixels_);
    lost_.resize(allowed_.size());
    for (const LodChunk& chunk : chunks)
      first_.push_back(first_.back() + allowed_.size() * chunk.levels.size());
    errors_.resize(first_.back());
    const auto find_errors = [&](std::size_t c) {
      for (std::size_t v = 0; v < allowed_.size(); ++v)
        errors.find_errors(v, c, errors_.data() + first_[c] + v * chunks[c].levels.size());
    };
    parallel_for(chunks.size(), find_errors, chunks_at_once);
    for (std::size_t c = 0; c < chunks.size(); ++c) {
      if (chunks[c].levels.empty()) continue;
      chosen_[c] = chunks[c].levels.size() - 1;
      total_ += chunks[c].levels.back().count;
      for (std::size_t v = 0; v < lost_.size(); ++v) lost_[v] += error_of(v, c, chosen_[c]);
    }
  }

  std::vector<std::size_t> choose() {
    for (std::size_t c = 0; c < chunks_.size(); ++c) {
      for (std::size_t level = 0; chunks_[c].pixels.empty() && level < chosen_[c]; ++level) {
        if (fits(c, level)) take(c, level);
      }
    }
    const std::vector<Step> steps = steps_of_all();
    std::vector<bool> left(chunks_.size(), false);  // whether a step of the chunk was refused
    std::priority_queue<Step> others;               // steps of chunks with a refused step
    auto next = steps.begin();
    while (exceeds_budget(before_.empty() ? 1.0 : 1.0 / inertia) && fits_more()) {
      while (next != steps.end() && left[next->chunk]) ++next;
      const bool in_order = next != steps.end() && (others.empty() || others.top() < *next);
      if (!in_order && others.empty()) break;
      const Step step = in_order ? *next++ : others.top();
      if (!in_order) others.pop();
      if (try_step(step) && in_order) continue;
      left[step.chunk] = true;
      if (const Step other = best_step(step.chunk); other.worth > 0.0) others.push(other);
    }
    return chosen_;
  }

  /// Returns whether the views need more Gaussians than may be read.
  bool is_limited() const { return is_limited_ && exceeds_budget(1.0); }
  void move_errors_to(LevelChoice& choice) {
    choice.sphere_pixels = sphere_pixels_;
    choice.errors = std::move(errors_);
    choice.first = std::move(first_);
  }

 private:
  struct Step {
    double worth = 0.0;  // error saved per added Gaussian
    std::size_t chunk = 0, level = 0;
    bool operator<(const Step& other) const {
      return std::tuple(worth, other.chunk, level) < std::tuple(other.worth, chunk, other.level);
    }
    bool operator>(const Step& other) const { return other < *this; }
  };

  std::size_t count(std::size_t c, std::size_t level) const { return chunks_[c].levels[level].count; }
  std::size_t with(std::size_t c, std::size_t level) const {
    return total_ - count(c, chosen_[c]) + count(c, level);
  }
  bool fits(std::size_t c, std::size_t level) const { return with(c, level) <= max_gaussians_; }
  double error_of(std::size_t view, std::size_t c, std::size_t level) const {
    return errors_[first_[c] + view * chunks_[c].levels.size() + level];
  }

  /// Adds the steps that a chunk takes if none is refused. No step is worth more than the one before it.
  void add_steps(std::size_t c, std::vector<Step>& steps) const {
    double most = std::numeric_limits<double>::infinity();
    for (Step step = best_step(c, chosen_[c]); step.worth > 0.0; step = best_step(c, step.level)) {
      most = step.worth = std::min(most, step.worth);
      steps.push_back(step);
    }
  }

  /// Returns the steps of all chunks in the order of their worth, in which choose() takes them. A step's
  /// worth does not depend on other chunks, so one sort suffices.
  std::vector<Step> steps_of_all() const {
    std::vector<Step> all;
    std::mutex adding;
    const auto add = [&](std::size_t begin, std::size_t end) {
      std::vector<Step> steps;
      for (std::size_t c = begin; c < end; ++c) add_steps(c, steps);
      const std::lock_guard lock(adding);
      all.insert(all.end(), steps.begin(), steps.end());
    };
    parallel_chunks(chunks_.size(), chunks_at_once, add);
    parallel_sort(all.begin(), all.end(), std::greater<>());
    return all;
  }

  /// Takes a step if it is needed and fits; otherwise limits the chunk's further steps.
  bool try_step(const Step& step) {
    const auto [worth, c, level] = step;
    if (!fits(c, level)) {
      finest_[c] = level + 1;  // coarser levels may fit
    } else if (!needed(c, level)) {
      finest_[c] = next_needed(c, level);
    } else if (!may_be_read(c, level)) {
      is_limited_ = true;
      finest_[c] =
          new_ < max_read_ - max_read_ / min_free_divisor ? level + 1 : std::min(drawn_[c], chosen_[c]);
    } else {
      take(c, level);
      return true;
    }
    return false;
  }

  /// Returns the Gaussians that must be read for a step.
  std::size_t gaussians_to_read(std::size_t c, std::size_t level) const {
    return drawn_.empty() || level >= drawn_[c] ? 0 : count(c, level);
  }
  bool may_be_read(std::size_t c, std::size_t level) const {
    const std::size_t more = gaussians_to_read(c, level), others = new_ - gaussians_to_read(c, chosen_[c]);
    return more == 0 || others == 0 || (others <= max_read_ && more <= max_read_ - others);
  }

  /// Returns whether any view loses more than `times` its budget.
  bool exceeds_budget(double times) const {
    for (std::size_t v = 0; v < allowed_.size(); ++v)
      if (lost_[v] > times * allowed_[v]) return true;
    return false;
  }
  bool fits_more() const {
    return max_gaussians_ > total_ && max_gaussians_ - total_ > max_gaussians_ / min_free_divisor;
  }

  void take(std::size_t c, std::size_t level) {
    for (std::size_t v = 0; v < lost_.size(); ++v)
      lost_[v] += error_of(v, c, level) - error_of(v, c, chosen_[c]);
    total_ = with(c, level);
    new_ = new_ - gaussians_to_read(c, chosen_[c]) + gaussians_to_read(c, level);
    chosen_[c] = level;
  }

  /// Returns whether a view that sees the chunk loses too much; for an unseen chunk, whether any view does.
  bool needed(std::size_t c, std::size_t level) const {
    const bool is_seen = error_of(allowed_.size() - 1, c, chosen_[c]) == 0.0;
    for (std::size_t v = 0; v < allowed_.size(); ++v) {
      if (is_seen && error_of(v, c, chosen_[c]) == 0.0) continue;
      if (lost_[v] * inertia_of(before_, c, level) > allowed_[v]) return true;
    }
    return false;
  }

  /// If `level` is not needed, returns the finest level that may still be needed: hysteresis raises the error
  /// for levels no finer than the chunk's previous level.
  std::size_t next_needed(std::size_t c, std::size_t level) const {
    return before_.empty() || level >= before_[c] ? chosen_[c] : before_[c];
  }

  /// Returns the chunk's step that saves the most error per added Gaussian; with worth 0 if there is none.
  Step best_step(std::size_t c) const { return best_step(c, chosen_[c]); }
  Step best_step(std::size_t c, std::size_t from) const {
    Step best{0.0, c, 0};
    for (std::size_t level = from; level-- > finest_[c];) {
      double saved = 0.0;
      for (std::size_t v = 0; v < lost_.size(); ++v)
        saved = std::max(saved, error_of(v, c, from) - error_of(v, c, level));
      const double added = static_cast<double>(count(c, level)) - static_cast<double>(count(c, from));
      const double worth = inertia_of(before_, c, level) * saved / std::max(added, 1.0);
      if (worth > best.worth) best = {worth, c, level};
    }
    return best;
  }

  const std::vector<LodChunk>& chunks_;
  std::span<const std::size_t> drawn_;
  std::size_t max_read_, max_gaussians_;
  std::span<const std::size_t> before_;
  double sphere_pixels_ = 0.0;
  std::vector<double> allowed_, lost_;        // squared errors by view; the sphere is last
  std::vector<double> errors_;                // squared errors by chunk, then view, then level
  std::vector<std::size_t> first_ = {0};      // index of each chunk's first error
  std::vector<std::size_t> chosen_, finest_;  // finest_: the finest level that may be taken
  std::size_t total_ = 0, new_ = 0;           // Gaussians of chosen_, and those of them that must be read
  bool is_limited_ = false;
};

}  // namespace

LevelChoice choose_by_error(const std::vector<LodChunk>& chunks, const std::vector<DetailView>& views,
                            const ErrorBudget& budget, const VisibleChunks& visible,
                            std::span<const std::size_t> before) {
  ErrorChooser chooser(chunks, views, budget, visible, before);
  LevelChoice choice{.levels = chooser.choose(), .is_limited = chooser.is_limited()};
  chooser.move_errors_to(choice);
  for (const DetailView& view : views) choice.pixels.push_back(view.pixels);
  return choice;
}

double LevelChoice::error_of_view(std::size_t view, std::span<const std::size_t> any_levels) const {
  double sum = 0.0;
  for (std::size_t c = 0; c + 1 < first.size(); ++c)
    if (levels_of(c) > 0) sum += error_of_chunk(view, c, any_levels[c]);
  return sum;
}

double LevelChoice::error_of(std::span<const std::size_t> any_levels) const {
  double most = 0.0;
  for (std::size_t v = 0; v < pixels.size(); ++v) most = std::max(most, error_of_view(v, any_levels));
  return most;
}

double LevelChoice::error_saved(std::size_t chunk, std::size_t from, std::size_t to) const {
  const std::size_t levels_of_chunk = levels_of(chunk);
  double most = 0.0;
  for (std::size_t v = 0; v <= pixels.size(); ++v) {
    const double* const of_view = errors.data() + first[chunk] + v * levels_of_chunk;
    most = std::max(most, (of_view[from] - of_view[to]) / (v < pixels.size() ? pixels[v] : sphere_pixels));
  }
  return most;
}

RunningError::RunningError(std::shared_ptr<const LevelChoice> choice, std::vector<std::size_t> levels)
    : choice_(std::move(choice)), levels_(std::move(levels)) {
  for (std::size_t v = 0; v < choice_->pixels.size(); ++v)
    lost_.push_back(choice_->error_of_view(v, levels_));
}

void RunningError::follow(std::span<const std::size_t> levels) {
  for (std::size_t c = 0; c < levels_.size(); ++c) {
    if (levels_[c] == levels[c]) continue;
    for (std::size_t v = 0; v < lost_.size(); ++v)
      lost_[v] += choice_->error_of_chunk(v, c, levels[c]) - choice_->error_of_chunk(v, c, levels_[c]);
    levels_[c] = levels[c];
  }
}

// Rounding may leave a slightly negative sum.
double RunningError::error(std::size_t begin, std::size_t end) const {
  double most = 0.0;
  for (std::size_t v = begin; v < end; ++v) most = std::max(most, lost_[v]);
  return most;
}

}  // namespace binosplat
