#include "formats/level_stream.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace binosplat {

namespace {

// Gaussians that may lie read: a quarter of a GB with all their harmonics.
constexpr std::size_t read_ahead = 1 << 20;

}  // namespace

LevelStream::LevelStream(const std::filesystem::path& path, Need need)
    : scene_(path), need_(std::move(need)), parts_(scene_.parts()) {}

Model LevelStream::coarsest(const DetailNeed& need) {
  Model model = scene_.like();
  scene_.choose({}, need);
  scene_.read([&](const StreamedSog::Piece& piece) { parts_.replace(model, piece.part, piece.model); });
  parts_.take_changes();
  return model;
}

void LevelStream::want(std::span<const shared::View> views, std::vector<std::vector<SeenPart>> seen) {
  const bool same = std::ranges::equal(std::as_bytes(views), std::as_bytes(std::span(wanted_last_)));
  if (views.empty() || (same && seen.empty())) return;
  wanted_last_.assign(views.begin(), views.end());
  const std::lock_guard lock(mutex_);
  if (trouble_) return;
  wish_ = Wish{wanted_last_, std::move(seen)};
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
  return parts_.take_changes();
}

bool LevelStream::settled() const {
  const std::lock_guard lock(mutex_);
  return !wish_ && !works_ && pieces_.empty() && !trouble_;
}

std::optional<double> LevelStream::predicted_psnr() const {
  const std::lock_guard lock(mutex_);
  return predicted_psnr_;
}

}  // namespace binosplat
