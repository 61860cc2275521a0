// What a level stream does in a frame besides looking: takes what was read, or tries out a sample of it.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include "stream/level_stream.h"

namespace binosplat {

namespace {

// Of a frame's time, ms: what is neither drawing nor levels, and the least that levels need to go on at all.
constexpr double apart_ms = 1.2, brings_least_ms = 2.5;
constexpr std::size_t taken_at_once = 1 << 14;  // Gaussians, before one sees what that took
constexpr int between_samples = 30;             // frames, of which each sample takes four
constexpr double unnoticed = 0.05;              // by which what is found may change, of itself

}  // namespace

double time_for_levels(double frame_ms, double drawn_ms) {
  return std::clamp(frame_ms - drawn_ms - apart_ms, brings_least_ms, LevelStream::brings_most_ms);
}

ModelParts::Changes LevelStream::take(Model& model, std::size_t most) {
  const double look_ms = std::exchange(look_ms_, 0.0);
  end_ahead();
  const bool is_ahead = taker_.joinable();
  ++frames_since_sample_;
  take_is_due_ = false;
  {
    const std::lock_guard lock(mutex_);
    if (trouble_) std::rethrow_exception(trouble_);
    const bool tries = tries_out() && taken_.empty();
    may_try_ = tries && (is_ahead || look_ms == 0.0);
    if (tries) return {};
  }
  if (!is_ahead) take_now(model, most, (brings_ms_ - look_ms) / 2.0);  // uploading takes as long
  std::vector<Taken> all;
  {
    const std::lock_guard lock(mutex_);
    all.swap(taken_);
    take_is_due_ = is_ahead ? !all.empty() : look_ms > 0.0 && !pieces_.empty();
  }
  new_ = 0;
  if (all.empty()) return {};
  for (const Taken& taken : all) {
    if (taken.level) drawn_[taken.part] = *taken.level;
    new_ += taken.count;
  }
  gaussians_ = parts_.gaussians();
  changed_since_look_ = true;
  changed_.notify_all();
  taken_at_ = Clock::now();
  return parts_.take_changes();
}

void LevelStream::take_now(Model& model, std::size_t most, double ms) {
  if (ms <= 0.0) return;
  const auto start = Clock::now();
  std::size_t taken = 0;
  double took_ms = 0.0;
  for (bool is_first = true; took_ms < ms && taken < most; is_first = false) {
    const auto some = take_some(model, most - taken, is_first);
    if (!some) break;
    taken += *some;
    took_ms = ms_since(start);
  }
  note_taken(taken, took_ms);
  could_take_ += std::min(most, static_cast<std::size_t>(ms * taken_a_ms_));
}

void LevelStream::note_taken(std::size_t taken, double ms) {
  if (taken >= taken_at_once) taken_a_ms_ = std::lerp(taken_a_ms_, static_cast<double>(taken) / ms, 0.1);
}

// What the last take() gave, which is on the GPU now.
void LevelStream::note_uploaded() {
  const std::size_t uploaded = std::exchange(new_, 0);
  if (uploaded >= taken_at_once) {
    const double ms = std::max(ms_since(taken_at_), 1e-3);
    uploaded_a_ms_ = std::lerp(uploaded_a_ms_, static_cast<double>(uploaded) / ms, 0.1);
  }
}

// A frame either looks or uploads: for both it has no time.
void LevelStream::take_ahead(Model& model, std::size_t most) {
  if (!taker_.joinable()) taker_ = std::jthread([this](const std::stop_token& stop) { take_on(stop); });
  if (look_ms_ == 0.0 && looks_next()) return;
  const std::lock_guard lock(mutex_);
  if (trouble_ || tries_out()) return;
  const auto uploads = static_cast<std::size_t>(expected_share * brings_ms_ * uploaded_a_ms_);
  ahead_ = {.model = &model,
            .most = std::min(most, std::max(uploads, taken_at_once)),  // or one would learn nothing any more
            .begin = Clock::now()};
  came_.notify_all();
}

bool LevelStream::looks_next() const {
  const bool waits = looked_.empty() && looked_at_ && ms_since(*looked_at_) < between_looks_ms;
  return by_db_ && is_due_ && !waits;
}

void LevelStream::take_on(const std::stop_token& stop) {
  const auto is_asked = [&] {
    return ahead_ && !ahead_->ends && !pieces_.empty() &&
           (ahead_->taken == 0 || ahead_->taken < ahead_->most);
  };
  std::unique_lock lock(mutex_);
  while (came_.wait(lock, stop, is_asked) && !stop.stop_requested() && !trouble_) {
    Ahead& ahead = *ahead_;
    ahead.is_at_work = true;
    lock.unlock();
    std::exception_ptr trouble;
    std::optional<std::size_t> some;
    const auto start = Clock::now();
    try {
      some = take_some(*ahead.model, std::max(ahead.most, ahead.taken) - ahead.taken, ahead.taken == 0);
    } catch (...) {
      trouble = std::current_exception();
    }
    const double took_ms = ms_since(start);
    lock.lock();
    if (trouble) trouble_ = trouble;
    ahead.taken += some.value_or(0);
    ahead.took_ms += took_ms;
    ahead.ends = ahead.ends || (!some && !pieces_.empty());  // what comes next is too much
    ahead.is_at_work = false;
    came_.notify_all();
  }
}

void LevelStream::end_ahead() {
  std::unique_lock lock(mutex_);
  if (!ahead_) return;
  ahead_->ends = true;
  came_.wait(lock, [&] { return !ahead_->is_at_work; });
  const Ahead ahead = *std::exchange(ahead_, std::nullopt);
  note_taken(ahead.taken, ahead.took_ms);
  could_take_ += std::min(ahead.most, static_cast<std::size_t>(ms_since(ahead.begin) * taken_a_ms_));
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
      taken_.push_back({pieces_.front().part, pieces_.front().level, count});
      taken.push_back(std::move(pieces_.front()));
      pieces_.pop_front();
    }
    gaussians_read_ -= gaussians;
  }
  if (taken.empty()) return std::nullopt;
  std::vector<ModelParts::Replacement> replacements;
  for (const StreamedSog::Piece& piece : taken) {
    replacements.push_back({piece.part, &piece.model});
  }
  parts_.replace(model, replacements);
  const std::lock_guard lock(mutex_);
  std::ranges::move(taken, std::back_inserter(used_));
  return gaussians;
}

// Nobody else changes a sample that is there.
void LevelStream::try_out(Model& model, const PartsTrial& trial) {
  is_tried_out_ = true;
  if (!std::exchange(may_try_, false) || look_ms_ > 0.0) return;
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
      gaussians_ = parts_.gaussians();
      trial_ = Trial::compares;
      return;
    case Trial::compares: {
      const double factor = found_.factor();
      LevelsLost& lost = *sample.lost;
      lost.follow(drawn_);
      found_.note(
          loss_of(lost.choice(), lost.error(0, 1), drawn_, sample.models.parts, trial.differs(sample.view)));
      found_other_ = std::abs(std::log(found_.factor() / factor)) > unnoticed;
      trial_ = Trial::puts_back;
      return;
    }
    case Trial::puts_back:
      sample.models = exchange(sample.models, model, parts_, trial);
      gaussians_ = parts_.gaussians();
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
  const bool has_all = !next_ && !reads_ && !has_pieces();
  return trial_ != Trial::keeps || !sample_->waits_for_all || moves_ || has_all;
}

}  // namespace binosplat
