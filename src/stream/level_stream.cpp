#include "stream/level_stream.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <iterator>
#include <limits>
#include <utility>

#include "base/parallel.h"

namespace binosplat {

namespace {

// Gaussians that may lie read: a quarter of a GB with all their harmonics.
constexpr std::size_t read_ahead = 1 << 20;
// Gaussians that room is made for at once, where nobody says how many there may be: 0.4 GB, or 1 with all
// their harmonics.
constexpr std::size_t room_most = 1 << 22;
constexpr double chooser_share = 0.25, reader_share = 0.5;  // of the cores: the rest is for frames
constexpr double look_most_ms = 360.0;  // at all bands of all views: slow frames have fewer bands
constexpr double stays_s = 1.0;         // a level that nothing needs any more
constexpr double lead_s = 0.5;          // ahead of a head that moves: until what is chosen is drawn
// Of what frames could take since the last choice was asked for, what the next one may want: they go on with
// it while the one after it is made, which takes as long as from one to the next.
constexpr double comes_share = 2.0;
constexpr double comes_least = 1 << 14;  // Gaussians, however few frames there were
constexpr int looks_most_found = 8;      // at the same views, where a sample was found to lose another amount
constexpr std::size_t sample_of_moving = 8;  // parts

bool same(std::span<const shared::View> a, std::span<const shared::View> b) {
  return std::ranges::equal(std::as_bytes(a), std::as_bytes(b));
}

}  // namespace

LevelStream::LevelStream(const std::filesystem::path& path, Need need, std::size_t all_up_to)
    : scene_(path), need_(std::move(need)), parts_(scene_.parts()), all_up_to_(all_up_to) {}

Model LevelStream::coarsest(std::span<const shared::View> views) {
  const DetailNeed need = need_(scene_, views);
  shows_all_ = scene_.finest() <= std::min(all_up_to_, need.most);
  asked_by_db_ = need.db && !shows_all_;
  shares_ = need.shares && scene_.has_errors() && !shows_all_;
  by_db_ = asked_by_db_ || (shares_ && together_db_ > 0.0);
  scene_.choose({}, need);
  Model model = scene_.like();
  model.room =
      std::min(scene_.finest(), need.most < scene_.finest() ? need.most : room_most) + scene_.spare();
  // Touched now: the system gives memory a page at a time, and slowly while others decode (10 ms a frame).
  model.reserve(model.room);
  model.resize(std::min(model.room, room_most));
  model.resize(0);
  scene_.read([&](const StreamedSog::Piece& piece) { parts_.replace(model, piece.part, piece.model); });
  parts_.take_changes();
  drawn_ = scene_.chosen();
  gaussians_ = parts_.gaussians();
  return model;
}

void LevelStream::share(double together_db) {
  if (std::exchange(together_db_, together_db) == together_db || !shares_) return;
  by_db_ = asked_by_db_ || together_db_ > 0.0;
  looked_.clear();
  bands_.start_again();
  looks_ = 0;
  is_due_ = !wanted_.empty();
}

double LevelStream::left() const {
  const auto now = together_db_ > 0.0 ? predicted_psnr() : std::nullopt;
  if (!now) return together_db_;
  const std::lock_guard lock(mutex_);
  const bool is_chosen = asked_by_db_ || asked_of_ == together_db_;  // for what is shared now
  return left_of(together_db_, is_chosen ? asked_db_ : levels_share(together_db_), *now);
}

void LevelStream::want(std::span<const shared::View> views, const Look& look) {
  if (views.empty()) return;
  note_uploaded();
  motion_.note(views);
  if (!same(views, wanted_)) {
    if (views.size() != wanted_.size()) {
      looked_.clear();
      bands_.start_again();
    }
    wanted_.assign(views.begin(), views.end());
    looks_ = 0;
    is_due_ = true;
  }
  {
    const std::lock_guard lock(mutex_);
    is_due_ = is_due_ || (looks_again() && is_idle());
    if (tries_out()) return;
  }
  if (!is_due_) return;
  Wish wish;
  if (!by_db_) {
    wish.views = wanted_;
    wish.together_db = together_db_;
  } else {
    if (take_is_due_ || !look_on(look)) return;
    wish = {std::exchange(looked_, {}),
            {std::move(seen_), drawn_, to_come()},
            here(),
            *looked_at_,
            ahead_at_,
            together_db_,
            found_.to_choose_by(),
            next_sample(),
            !moves_};
    ++looks_;
  }
  is_due_ = !same(wish.views, wanted_);
  const std::lock_guard lock(mutex_);
  if (trouble_) return;
  wish_ = std::move(wish);
  if (!chooser_.joinable()) {
    chooser_ = std::jthread([this](const std::stop_token& stop) { choose_on(stop); });
    reader_ = std::jthread([this](const std::stop_token& stop) { read_on(stop); });
  }
  changed_.notify_all();
}

std::size_t LevelStream::here() const { return moves_ ? (to_look_at_ + 1) / 2 : to_look_at_; }

// At the next band or view; whether all have been looked at.
bool LevelStream::look_on(const Look& look) {
  if (looked_.empty()) {
    if (looked_at_ && ms_since(*looked_at_) < between_looks_ms) return false;
    looked_at_ = Clock::now();
    moves_ = !same(motion_.ahead(lead_s), wanted_);
    to_look_at_ = moves_ ? std::max<std::size_t>(wanted_.size(), 2) : wanted_.size();
    changed_since_look_ = found_other_ = false;
    seen_.clear();
    bands_looked_at_ = 0;
  }
  if (bands_.is_first()) {
    const std::size_t k = looked_.size();
    if (k == here())
      ahead_at_ =
          Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(lead_s));
    looked_.push_back(k < here() ? wanted_[k] : motion_.ahead(lead_s)[k % wanted_.size()]);
    seen_.emplace_back(parts_.size());
    bands_.begin(looked_.back(), expected_share * brings_ms_);
  }
  double took_ms = 0.0;
  bool is_last = false;
  do {
    const auto start = Clock::now();
    add_band(look(looked_.back(), bands_.next(), parts_), seen_.back());
    took_ms = ms_since(start);
    is_last = bands_.note(took_ms);
    ++bands_looked_at_;
  } while (!is_last && took_ms < LookBands::nothing_ms);
  look_ms_ = took_ms;
  if (!is_last || looked_.size() < to_look_at_) return false;
  const double frame_ms = ms_since(*looked_at_) / bands_looked_at_;
  bands_.allow(static_cast<int>(look_most_ms / (static_cast<double>(to_look_at_) * frame_ms)));
  return true;
}

// Whether it went well; if not, that is told, and nothing more is done.
bool LevelStream::works(double share_of_cores, const std::function<void()>& work) {
  try {
    // Drawing must not wait for a core, nor for memory that all others are clearing.
    on_some_cores(share_of_cores, work);
    return true;
  } catch (...) {
    const std::lock_guard lock(mutex_);
    if (!trouble_) trouble_ = std::current_exception();
    return false;
  }
}

void LevelStream::choose_on(const std::stop_token& stop) {
  Wish wish;
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    const auto is_there = [&] { return wish_.has_value(); };
    if (!lingers_ || is_limited_) {
      changed_.wait(lock, stop, is_there);
    } else if (!changed_.wait_for(lock, stop, std::chrono::duration<double>(stays_s), is_there)) {
      wish_ = wish;  // chosen again, without what stayed beyond it
    }
    if (!wish_ || stop.stop_requested()) continue;
    wish = *std::exchange(wish_, std::nullopt);
    chooses_ = true;
    lock.unlock();
    const bool went_well = works(chooser_share, [&] { choose(wish); });
    wish.sample.reset();
    lock.lock();
    chooses_ = false;
    if (!went_well) return;
    changed_.notify_all();
  }
}

void LevelStream::choose(const Wish& wish) {
  DetailNeed need = need_(scene_, wish.views);
  if (shows_all_) need.db.reset();
  if (shares_) need = scene_.sharing(need, wish.together_db);
  need.stays_s = stays_s;
  need.found = wish.found;
  auto chosen = scene_.chooser().choose(wish.views, need, wish.seen);
  std::shared_ptr<LevelsLost> lost;
  if (chosen->by_errors) lost = std::make_shared<LevelsLost>(chosen->by_errors, wish.seen.drawn);
  std::optional<Sample> sample;
  if (wish.sample && lost) {
    auto parts = wish.rests ? sample_of(*chosen->by_errors, chosen->levels, sample_of_rest, *wish.sample)
                            : sample_of(*chosen->by_errors, wish.seen.drawn, sample_of_moving, *wish.sample);
    if (!parts.empty()) sample = {lost, wish.views.front(), {std::move(parts), {}}, wish.rests};
  }
  const std::lock_guard lock(mutex_);
  lost_.swap(lost);  // the one before it is freed when no frame waits for the lock any more
  here_ = wish.here;
  chosen_at_ = wish.at;
  chosen_ahead_at_ = wish.ahead_at;
  lingers_ = chosen->lingers;
  is_limited_ = chosen->is_limited();
  asked_of_ = wish.together_db;
  asked_db_ = need.db.value_or(0.0);
  next_.swap(chosen);
  next_sample_.swap(sample);
}

void LevelStream::read_on(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    changed_.wait(lock, stop, [&] { return next_ != nullptr || !used_.empty(); });
    auto chosen = std::exchange(next_, nullptr);
    auto sample = std::exchange(next_sample_, std::nullopt);
    reads_ = chosen != nullptr;
    lock.unlock();
    free_used();
    const bool went_well = !chosen || works(reader_share, [&] {
      if (sample) read(std::move(*sample));
      read(std::move(chosen), stop);
    });
    lock.lock();
    reads_ = false;
    if (!went_well) return;
  }
}

void LevelStream::read(std::shared_ptr<const LevelsChosen> chosen, const std::stop_token& stop) {
  if (!scene_.choose(std::move(chosen))) return;
  sort_pieces();
  const auto take = [&](StreamedSog::Piece piece) {
    free_used();
    std::unique_lock lock(mutex_);
    changed_.wait(lock, stop, [&] { return gaussians_read_ < read_ahead || next_; });
    gaussians_read_ += piece.model.count();
    pieces_.push_back(std::move(piece));
    came_.notify_all();
  };
  scene_.read(take, [&] {
    const std::lock_guard lock(mutex_);
    return !stop.stop_requested() && !next_;
  });
}

void LevelStream::read(Sample sample) {
  sample.models = scene_.finest_of(sample.models.parts);
  if (const std::lock_guard lock(mutex_); !sample_) sample_ = std::move(sample);
}

void LevelStream::free_used() {
  std::vector<StreamedSog::Piece> used;
  const std::lock_guard lock(mutex_);
  used.swap(used_);
}

// Drops what was read for views that are gone; what saves most comes first. A frame meanwhile, which must not
// wait for that, finds nothing to take.
void LevelStream::sort_pieces() {
  std::deque<StreamedSog::Piece> pieces;
  {
    const std::lock_guard lock(mutex_);
    pieces.swap(pieces_);
  }
  std::size_t dropped = 0;
  std::erase_if(pieces, [&](const StreamedSog::Piece& piece) {
    if (scene_.wants(piece)) return false;
    scene_.put_back(piece);  // no other of this part has been read since, or this one would be gone
    dropped += piece.model.count();
    return true;
  });
  std::ranges::stable_sort(pieces, std::greater<>(),
                           [&](const StreamedSog::Piece& piece) { return scene_.worth(piece); });
  const std::lock_guard lock(mutex_);
  gaussians_read_ -= dropped;
  pieces_ = std::move(pieces);
  came_.notify_all();
}

// Coarse parts hide what fine ones do not.
bool LevelStream::looks_again() const {
  return by_db_ && (is_limited_ || (changed_since_look_ && looks_ < looks_most) ||
                    (found_other_ && looks_ < looks_most_found));
}

// Where a head rests nothing comes too late, nor before it was ever seen.
std::size_t LevelStream::to_come() {
  const double all = comes_share * static_cast<double>(std::exchange(could_take_, 0));
  const bool rests = looks_ > 0 || !std::exchange(has_wished_, true);
  return rests ? std::numeric_limits<std::size_t>::max()
               : static_cast<std::size_t>(std::clamp(all, comes_least, 1e15));
}

bool LevelStream::settled() const {
  const std::lock_guard lock(mutex_);
  return is_idle() && !is_due_ && !looks_again() && !lingers_ && !trouble_;
}

std::optional<double> LevelStream::predicted_psnr() const {
  std::shared_ptr<LevelsLost> lost;
  std::size_t here = 0;
  Clock::time_point at, ahead_at;
  {
    const std::lock_guard lock(mutex_);
    lost = lost_;
    here = here_;
    at = chosen_at_;
    ahead_at = chosen_ahead_at_;
  }
  if (!lost) return std::nullopt;
  lost->follow(drawn_);
  const std::size_t all = lost->choice().pixels.size();
  const double here_error = lost->error(0, here);
  const double ahead_error = here < all ? lost->error(here, all) : here_error;
  // What comes nearer loses the more the nearer it is.
  const double until_ms = std::chrono::duration<double, std::milli>(ahead_at - at).count();
  const double ahead = until_ms > 0.0 ? std::pow(std::min(ms_since(at) / until_ms, 1.0), 2) : 0.0;
  return psnr_of_error(found_.factor() * std::lerp(here_error, ahead_error, ahead));
}

}  // namespace binosplat
