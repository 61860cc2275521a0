#include "stream/picture_stream.h"

#include <utility>

namespace binosplat {

namespace {

constexpr int max_choices = 3;  // for the same views; further choices would hardly differ
// Maximum number of samples for a picture. If a sample shows that the levels miss the request by more than
// misses_db, finer levels are chosen. Each further miss raises the request by more_db.
constexpr int max_samples = 8;
constexpr double misses_db = 1.0, more_db = 3.0;

}  // namespace

bool PictureStream::settle(std::span<const shared::View> views, const render::FrameSettings& settings,
                           const std::function<void()>& before_change) {
  if (views.empty() || (settings.quality == quality_ && equal_last_views(views))) return false;
  views_.assign(views.begin(), views.end());
  quality_ = settings.quality;
  if (!settings_.detail.heads_turn) {  // a picture does not depend on earlier ones
    chooser_.forget();
    loss_correction_ = {};
    samples_ = 0;
  }
  const DetailRequest request = request_for(views);
  if (settings_.max_in_memory)
    model_.capacity = std::min(request.max_gaussians, files_.finest()) + files_.extra_capacity();
  bool changed = false;
  const auto change = [&](const LevelChoice& choice) {
    if (!std::exchange(changed, true) && before_change) before_change();
    read_levels(choice);
  };
  if (!settings_.detail.heads_turn) {
    if (request.db) {  // the first measurement uses the coarsest levels
      start_over();
      change(chooser_.choose({}, {}, {}));
    } else if (choose_levels(files_.chunks(), views, request).levels != drawn_) {
      start_over();
    }
  }
  if (request.db) visibility_.emplace(gpu_model_);
  LevelChoice choice;
  for (int k = 0; k < (request.db ? max_choices : 1); ++k) {
    choice = chooser_.choose(views, request, request.db ? measure(views, settings) : VisibleChunks());
    if (choice.levels == drawn_) break;
    change(choice);
  }
  sample_error_ = 0.0;  // stays 0 if levels are not chosen by dB
  for (int sample = 1; request.db && sample <= max_samples; ++sample) {
    const VisibleChunks visible = calibrate(views, settings, choice);
    DetailRequest finer = request_for(views);
    const bool keeps = sample > 1 && reported(choice.error()) > *finer.db - misses_db;
    if (keeps || visible.drawn.empty() || sample == max_samples) break;
    *finer.db += more_db * (sample - 1);
    choice = chooser_.choose(views, finer, visible);
    if (choice.levels == drawn_) break;
    change(choice);
  }
  choice_.reset();
  if (request.db) choice_ = std::move(choice);
  visibility_.reset();  // frees the memory of its frame
  return changed;
}

std::optional<double> PictureStream::reported_db() const {
  if (!choice_) return std::nullopt;
  return reported(choice_->error_of(drawn_));
}

}  // namespace binosplat
