#include "formats/level_stream.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

namespace binosplat {

namespace {

// Gaussians that may lie read: a quarter of a GB with all their harmonics.
constexpr std::size_t read_ahead = 1 << 20;
// Gaussians that room is made for at once, where nobody says how many there may be: 0.4 GB, or 1 with all
// their harmonics.
constexpr std::size_t room_most = 1 << 22;
constexpr double between_looks_ms = 100.0;
constexpr int looks_most = 3;  // at the same views; then a choice hardly changes any more

}  // namespace

LevelStream::LevelStream(const std::filesystem::path& path, Need need)
    : scene_(path), need_(std::move(need)), parts_(scene_.parts()) {}

Model LevelStream::coarsest(const DetailNeed& need) {
  by_db_ = need.db.has_value();
  scene_.choose({}, need);
  Model model = scene_.like();
  // Half empty blocks included.
  model.room = std::min(scene_.finest(), need.most < scene_.finest() ? need.most : room_most) +
               scene_.parts() * ModelParts::block;
  model.reserve(model.room);
  scene_.read([&](const StreamedSog::Piece& piece) { parts_.replace(model, piece.part, piece.model); });
  parts_.take_changes();
  return model;
}

void LevelStream::want(std::span<const shared::View> views, const Look& look) {
  if (views.empty()) return;
  if (!std::ranges::equal(std::as_bytes(views), std::as_bytes(std::span(wanted_)))) {
    wanted_.assign(views.begin(), views.end());
    looks_ = 0;
    look_is_due_ = true;
  }
  if (!look_is_due_ || (by_db_ && looked_at_ && ms_since(*looked_at_) < between_looks_ms)) return;
  look_is_due_ = false;
  Wish wish{wanted_, {}};
  if (by_db_) {
    wish.seen = look(parts_);
    looked_at_ = Clock::now();
  }
  const std::lock_guard lock(mutex_);
  looks_ += !works_ && pieces_.empty() ? 1 : 0;
  if (trouble_) return;
  wish_ = std::move(wish);
  if (!thread_.joinable()) thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
  changed_.notify_all();
}

void LevelStream::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [&] { return wish_.has_value(); })) {
    const Wish wish = *std::exchange(wish_, std::nullopt);
    works_ = true;
    lock.unlock();
    std::exception_ptr trouble;
    try {
      read(wish, stop);
    } catch (...) {
      trouble = std::current_exception();
    }
    lock.lock();
    works_ = false;
    predicted_psnr_ = scene_.predicted_psnr();
    trouble_ = trouble;
    if (trouble_) return;
  }
}

void LevelStream::read(const Wish& wish, const std::stop_token& stop) {
  if (!scene_.choose(wish.views, need_(scene_, wish.views), wish.seen)) return;
  drop_unwanted();
  const auto take = [&](StreamedSog::Piece piece) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, stop, [&] { return gaussians_read_ < read_ahead; });
    gaussians_read_ += piece.model.count();
    pieces_.push_back(std::move(piece));
  };
  scene_.read(take, [&] {
    const std::lock_guard lock(mutex_);
    return !stop.stop_requested() && !wish_;
  });
}

// What was read for views that are gone.
void LevelStream::drop_unwanted() {
  const std::lock_guard lock(mutex_);
  for (auto piece = pieces_.end(); piece != pieces_.begin();) {
    --piece;
    if (scene_.wants(*piece)) continue;
    const auto later = std::find_if(std::next(piece), pieces_.end(),
                                    [&](const auto& other) { return other.part == piece->part; });
    if (later == pieces_.end()) {
      scene_.put_back(*piece);
    } else {
      later->before = piece->before;
    }
    gaussians_read_ -= piece->model.count();
    piece = pieces_.erase(piece);
  }
}

ModelParts::Changes LevelStream::take(Model& model, std::size_t most) {
  std::vector<StreamedSog::Piece> taken;
  {
    const std::lock_guard lock(mutex_);
    if (trouble_) std::rethrow_exception(trouble_);
    std::size_t gaussians = 0;
    while (!pieces_.empty()) {
      gaussians += pieces_.front().model.count();
      if (!taken.empty() && gaussians > most) break;
      gaussians_read_ -= pieces_.front().model.count();
      taken.push_back(std::move(pieces_.front()));
      pieces_.pop_front();
    }
  }
  if (taken.empty()) return {};
  changed_.notify_all();
  for (const StreamedSog::Piece& piece : taken) parts_.replace(model, piece.part, piece.model);
  look_is_due_ = look_is_due_ || (by_db_ && looks_ < looks_most);  // coarse parts hide what fine ones do not
  return parts_.take_changes();
}

bool LevelStream::settled() const {
  const std::lock_guard lock(mutex_);
  return !wish_ && !works_ && pieces_.empty() && !look_is_due_ && !trouble_;
}

std::optional<double> LevelStream::predicted_psnr() const {
  const std::lock_guard lock(mutex_);
  return predicted_psnr_;
}

}  // namespace binosplat
