// What a level stream does in a frame besides looking: takes what was read, or tries out a sample of it.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include "formats/level_stream.h"

namespace binosplat {

namespace {

// Of a frame's time, ms: what is neither drawing nor levels, and the least that levels need to go on at all.
constexpr double apart_ms = 1.2, brings_least_ms = 2.5;
constexpr std::size_t taken_at_once = 1 << 14;  // Gaussians, before one sees what that took
constexpr int between_samples = 20;             // frames, of which each sample takes four
constexpr double unnoticed = 0.05;              // by which what is found may change, of itself

}  // namespace

double time_for_levels(double frame_ms, double drawn_ms) {
  return std::clamp(frame_ms - drawn_ms - apart_ms, brings_least_ms, LevelStream::brings_most_ms);
}

ModelParts::Changes LevelStream::take(Model& model, std::size_t most) {
  const double look_ms = std::exchange(look_ms_, 0.0);
  const double ms = (brings_ms_ - look_ms) / 2.0;  // uploading takes as long
  ++frames_since_sample_;
  {
    const std::lock_guard lock(mutex_);
    if (trouble_) std::rethrow_exception(trouble_);
    take_is_due_ = look_ms > 0.0 && !pieces_.empty();
    const bool tries = tries_out();
    may_try_ = tries && look_ms == 0.0;
    if (tries) return {};
  }
  if (ms <= 0.0) return {};
  const auto start = Clock::now();
  std::optional<std::size_t> taken;  // Gaussians, which may be none
  double took_ms = 0.0;
  while (took_ms < ms && taken.value_or(0) < most) {
    const auto some = take_some(model, most - taken.value_or(0), !taken);
    if (!some) break;
    taken = taken.value_or(0) + *some;
    took_ms = ms_since(start);
  }
  if (taken >= taken_at_once)
    taken_a_ms_ = std::lerp(taken_a_ms_, static_cast<double>(*taken) / took_ms, 0.1);
  could_take_ += std::min(most, static_cast<std::size_t>(ms * taken_a_ms_));
  if (!taken) return {};
  if (take_is_due_) {
    const std::lock_guard lock(mutex_);
    take_is_due_ = !pieces_.empty();
  }
  changed_since_look_ = true;
  told_by_.reset();
  changed_.notify_all();
  return parts_.take_changes();
}

// Some parts of what was read, of no more than so many Gaussians, but one part if it is the first; how many
// there are, if any.
std::optional<std::size_t> LevelStream::take_some(Model& model, std::size_t most, bool is_first) {
  std::vector<StreamedSog::Piece> taken;
  std::size_t gaussians = 0;
  {
    const std::lock_guard lock(mutex_);
    while (!pieces_.empty() && gaussians < taken_at_once) {
      const std::size_t count = pieces_.front().model.count();
      if (gaussians + count > most && !(is_first && taken.empty())) break;
      gaussians += count;
      taken.push_back(std::move(pieces_.front()));
      pieces_.pop_front();
    }
    gaussians_read_ -= gaussians;
  }
  if (taken.empty()) return std::nullopt;
  std::vector<ModelParts::Replacement> replacements;
  for (const StreamedSog::Piece& piece : taken) {
    replacements.push_back({piece.part, &piece.model});
    if (piece.level) drawn_[piece.part] = *piece.level;
  }
  parts_.replace(model, replacements);
  const std::lock_guard lock(mutex_);
  std::ranges::move(taken, std::back_inserter(used_));
  return gaussians;
}

// Nobody else changes a sample that is there.
void LevelStream::try_out(Model& model, const PartsTrial& trial) {
  is_tried_out_ = true;
  if (!std::exchange(may_try_, false)) return;
  Sample& sample = *sample_;
  switch (trial_) {
    case Trial::keeps:
      keep_what_fits(sample.models, model, parts_);
      if (sample.models.parts.empty()) break;
      trial.keep(sample.view);
      trial_ = Trial::exchanges;
      return;
    case Trial::exchanges:
      sample.models = exchange(sample.models, model, parts_, trial);
      trial_ = Trial::compares;
      return;
    case Trial::compares: {
      const double factor = found_.factor();
      found_.note(loss_of(*sample.choice, drawn_, sample.models.parts, trial.differs(sample.view)));
      found_other_ = std::abs(std::log(found_.factor() / factor)) > unnoticed;
      trial_ = Trial::puts_back;
      return;
    }
    case Trial::puts_back:
      sample.models = exchange(sample.models, model, parts_, trial);
      trial_ = Trial::keeps;
      break;
  }
  const std::lock_guard lock(mutex_);
  sample_.reset();
}

std::optional<unsigned> LevelStream::next_sample() {
  if (!is_tried_out_ || (samples_ > 0 && frames_since_sample_ < between_samples)) return std::nullopt;
  frames_since_sample_ = 0;
  return samples_++;
}

// What a head that rests sees is what was chosen for it, once that is there.
bool LevelStream::tries_out() const {
  if (!sample_) return false;
  const bool has_all = !next_ && !reads_ && pieces_.empty();
  return trial_ != Trial::keeps || !sample_->waits_for_all || moves_ || has_all;
}

}  // namespace binosplat
