// What a stream does for pictures that may wait.

#include <algorithm>
#include <memory>
#include <utility>

#include "stream/stream.h"

namespace binosplat {

namespace {

constexpr int choices_most = 3;  // for the same views: after them a choice hardly changes any more
// Gaussians at whose finest levels it is measured what levels lose: of a picture, or of each of a turning
// head's.
constexpr std::size_t sample_of_one = 1 << 17, sample_of_many = 1 << 14;
// Samples of a picture: levels that one shows to miss what was asked for by more than this become finer, and
// each further miss asks for so much more than what was asked for.
constexpr int samples_most = 8;
constexpr double misses_db = 1.0, more_db = 3.0;

/// Takes of `other` what shows more than `visible` does.
void show_more(VisibleChunks& visible, const VisibleChunks& other) {
  for (std::size_t v = 0; v < visible.by_view.size(); ++v) {
    for (std::size_t c = 0; c < visible.by_view[v].size(); ++c)
      if (other.by_view[v][c].area > visible.by_view[v][c].area) visible.by_view[v][c] = other.by_view[v][c];
  }
}

}  // namespace

bool Stream::settle(std::span<const shared::View> views, const render::FrameSettings& settings,
                    const std::function<void()>& before_change) {
  const bool is_settled = !worker_ && settings.quality == quality_ && are_last(views);
  if (is_settled || views.empty()) return false;
  worker_.reset();
  views_.assign(views.begin(), views.end());
  quality_ = settings.quality;
  if (!settings_.detail.heads_turn) {  // nothing counts that was found for other pictures
    chooser_.forget();
    calibration_ = {};
    samples_ = 0;
  }
  const DetailRequest request = request_for(views);
  if (settings_.room) model_.room = std::min(request.most, files_.finest()) + files_.spare();
  bool changed = false;
  const auto change = [&](const LevelChoice& choice) {
    if (!std::exchange(changed, true) && before_change) before_change();
    bring_to(choice);
  };
  if (!settings_.detail.heads_turn) {
    if (request.db) {  // what is measured first is the coarsest
      start_over();
      change(chooser_.choose({}, {}, {}));
    } else if (choose_levels(files_.chunks(), views, request).levels != drawn_) {
      start_over();
    }
  }
  if (request.db) visibility_.emplace(gpu_model_);
  LevelChoice choice;
  for (int k = 0; k < (request.db ? choices_most : 1); ++k) {
    choice = chooser_.choose(views, request, request.db ? measure(views, settings) : VisibleChunks());
    if (choice.levels == drawn_) break;
    change(choice);
  }
  sample_error_ = 0.0;  // where dB are not gone by
  for (int sample = 1; request.db && sample <= samples_most; ++sample) {
    const VisibleChunks visible = calibrate(views, settings, choice);
    DetailRequest finer = request_for(views);
    const bool keeps = sample > 1 && reported(choice.error()) > *finer.db - misses_db;
    if (keeps || visible.drawn.empty() || sample == samples_most) break;
    *finer.db += more_db * (sample - 1);
    choice = chooser_.choose(views, finer, visible);
    if (choice.levels == drawn_) break;
    change(choice);
  }
  chosen_ = {.here = views.size()};
  if (request.db)
    chosen_.error =
        std::make_shared<RunningError>(std::make_shared<const LevelChoice>(std::move(choice)), drawn_);
  visibility_.reset();  // it takes the memory of a small frame
  return changed;
}

/// Measures what the levels drawn lose in the first view, by a picture with a sample of chunks at their
/// finest, and puts that into the choice. Returns what both pictures show; of no chunks where there is no
/// sample. Where the sample is all that is not at its finest, a chunk counts as seen as much as in the
/// picture that shows more of it: it may hide others, or reach into the picture, at one of both levels only,
/// and what is lost there would be predicted to be nothing. Of fewer chunks that would be reported too often
/// of those in the sample.
VisibleChunks Stream::calibrate(std::span<const shared::View> views, const render::FrameSettings& settings,
                                LevelChoice& choice) {
  const std::size_t gaussians = settings_.detail.heads_turn ? sample_of_many : sample_of_one;
  const std::size_t most =
      std::max<std::size_t>(gaussians * chunks_.size() / std::max<std::size_t>(files_.finest(), 1), 1);
  sample_error_ = 0.0;
  ChunkModels finest = files_.finest_of(sample_of(choice, drawn_, most, samples_++));
  if (settings_.room) keep_what_fits(finest, model_, chunks_);
  if (finest.chunks.empty()) return {};
  visibility_->keep_picture(views.front(), settings);
  VisibleChunks visible = measure(views, settings);
  const ChunkModels before = exchange(finest, model_, chunks_);
  gpu_model_->reload(chunks_.take_changes());
  sample_error_ = visibility_->picture_error(views.front(), settings);
  const auto finest_already = static_cast<std::size_t>(std::ranges::count(drawn_, 0u));
  if (finest.chunks.size() + finest_already == drawn_.size()) show_more(visible, measure(views, settings));
  exchange(before, model_, chunks_);
  gpu_model_->reload(chunks_.take_changes());
  choice = chooser_.choose(views, request_for(views), visible);
  choice.levels = drawn_;
  calibration_.add(sample_error(choice, drawn_, finest.chunks, sample_error_));
  return visible;
}

VisibleChunks Stream::measure(std::span<const shared::View> views, const render::FrameSettings& settings) {
  return {visibility_->measure(views, settings, chunks_), drawn_};
}

/// As if nothing had been read yet but what belongs to every level.
void Stream::start_over() {
  model_.resize(0);
  chunks_ = ModelChunks(chunks_.size());
  drawn_.clear();
  for (const LodChunk& chunk : files_.chunks())
    drawn_.push_back(chunk.levels.empty() ? 0 : LodFiles::not_read);  // there is nothing to read of some
  chunks_.replace(model_, files_.chunks().size(), files_.environment());
}

/// Reads, and uploads where there is a model on the GPU: whole for single pictures, whose Gaussians lie in
/// another order each time.
void Stream::bring_to(const LevelChoice& choice) {
  const auto reading = Clock::now();
  const std::vector<std::size_t> from = drawn_;
  files_.read(from, choice, [&](const LodFiles::Piece& piece) { put({&piece, 1}); });
  times_.read_ms += ms_since(reading);
  const ModelChunks::Changes changes = chunks_.take_changes();
  if (!gpu_model_) return;
  const auto uploading = Clock::now();
  if (settings_.detail.heads_turn) {
    gpu_model_->reload(changes);
  } else {
    gpu_model_->reload();
  }
  times_.upload_ms += ms_since(uploading);
}

}  // namespace binosplat
