#include "stream/stream.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/thread_spans.h"

namespace binosplat {

namespace {

constexpr double between_passes_ms = 100.0;  // meanwhile the worker reads the levels of the last pass
constexpr int max_passes = 3;                // for the same views; further choices would hardly differ
constexpr double lead_s = 0.5;  // views are predicted for the time at which requested levels are drawn
constexpr std::size_t min_timed_upload = 1 << 14;  // Gaussians; smaller uploads do not measure the rate
constexpr double upload_share = 0.75;              // share of begin_frame()'s `ms`
// The limit of a request is requests_at_once times the Gaussians that frames had time to upload since the
// previous request. The factor is above 1, because a request stays active while the next one is made. The
// limit is at least min_requested.
constexpr double requests_at_once = 2.0, min_requested = 1 << 14;
// The loss of levels is calibrated while the views rest. When a head has moved on, this factor multiplies the
// predicted loss (tests/bench/results/levels.md has others). Along walks the true factor was 0.7 to 1.6. The
// factor here is above the middle of that range, because missing the requested dB is worse than exceeding
// them.
constexpr double extrapolation_factor = 1.3;
// ms of a frame for work other than drawing and levels
constexpr double apart_ms = 1.2;

}  // namespace

double time_for_levels(double frame_ms, double drawn_ms) {
  return std::clamp(frame_ms - drawn_ms - apart_ms, 2.5, max_levels_ms);
}

std::optional<double> Stream::reported_db() const {
  const StreamWorker::Chosen chosen = worker_.chosen();
  if (!chosen.error) return std::nullopt;
  chosen.error->follow(drawn_);
  const double current = chosen.error->error(0, chosen.current_views);
  if (chosen.current_views == chosen.error->views()) return reported(current, loss_factor());
  // The share is squared, because the loss of a chunk grows faster the nearer the chunk comes.
  const double share = std::min(1e-3 * ms_since(chosen.at) / lead_s, 1.0);
  const double predicted = chosen.error->error(chosen.current_views, chosen.error->views());
  return reported(std::lerp(current, predicted, share * share), loss_factor());
}

// The factor on the predicted loss. Views without a calibration have a larger one.
double Stream::loss_factor() const { return is_calibrated_ ? 1.0 : extrapolation_factor; }

bool Stream::begin_frame(std::span<const shared::View> views, const render::FrameSettings& settings,
                         double ms) {
  if (views.empty()) return false;
  worker_.check();
  motion_.note(views);
  if (!equal_last_views(views) || settings.quality != quality_) {
    if (views.size() != views_.size() || settings.quality != quality_) pass_.views.clear();
    views_.assign(views.begin(), views.end());
    quality_ = settings.quality;
    passes_ = 0;
    is_due_ = true;
    is_calibrated_ = false;
  }
  is_due_ = is_due_ || needs_another_pass();
  if (is_due_ && !levels_db_for(quality_)) {
    request({.views = views_});
    is_due_ = false;
  }
  uploads_in_time_ += upload_share * ms * uploads_per_ms_;
  const bool made_pass = std::exchange(made_pass_, false), is_due = pass_is_due();
  // A frame has no time for both a pass and an upload, so they alternate.
  if ((!is_due || made_pass) && upload_loaded(ms)) return true;
  if (is_due) {
    make_pass(settings);
  } else if (levels_db_for(quality_) && !is_calibrated_ && has_all()) {
    calibrate_at_rest(settings);
  }
  return false;
}

void Stream::prepare(std::span<const shared::View> views, const render::FrameSettings& settings) {
  // Uploads one unchanged Gaussian, which compiles the shader for levels.
  gpu_model_->reload({.filled = {{0, 1}}, .emptied = {}});
  if (!levels_db_for(settings.quality)) return;
  measure(views.first(1), settings);  // as in a pass
  measure(views, settings);           // as in calibration at rest
  visibility_->keep_picture(views.front(), settings);
  visibility_->picture_error(views.front(), settings);
}

bool Stream::settled() const { return has_all() && (is_calibrated_ || !levels_db_for(quality_)); }

bool Stream::has_all() const {
  return worker_.is_idle() && !is_due_ && pass_.views.empty() && !needs_another_pass();
}

// Coarse chunks hide more than fine ones, so visibility changes with the levels.
bool Stream::needs_another_pass() const {
  return levels_db_for(quality_) && worker_.is_idle() &&
         (worker_.chosen().is_limited || (pass_.is_outdated && passes_ < max_passes));
}

bool Stream::pass_is_due() const {
  if (!levels_db_for(quality_)) return false;
  if (!pass_.views.empty()) return true;
  return is_due_ && !worker_.is_choosing() && ms_since(worker_.chosen().made_at) >= between_passes_ms;
}

// Measures one more view of the pass: a current view, or a view predicted now.
void Stream::make_pass(const render::FrameSettings& settings) {
  const TimedSpan span("visibility pass");
  const std::vector<shared::View> predicted = motion_.predicted(lead_s);
  if (pass_.views.empty()) {
    const bool moves = !equal_last_views(predicted);
    pass_ = {.all = std::max<std::size_t>(views_.size(), moves ? 2 : 1), .began = Clock::now()};
    pass_.current_views = moves ? (pass_.all + 1) / 2 : pass_.all;
  }
  const std::size_t k = pass_.views.size();
  const shared::View view = k < pass_.current_views ? views_[k] : predicted[k % predicted.size()];
  pass_.views.push_back(view);
  pass_.visible.by_view.push_back(std::move(measure({&view, 1}, settings).by_view.front()));
  made_pass_ = true;
  if (pass_.views.size() < pass_.all) return;
  is_due_ = !equal_last_views(pass_.views);
  pass_.visible.drawn = drawn_;
  request({.views = std::exchange(pass_.views, {}),
           .visible = std::move(pass_.visible),
           .current_views = pass_.current_views,
           .at = pass_.began});
  ++passes_;
}

// While a head moves, a request is limited to the Gaussians that frames can upload in time. All visible
// chunks then improve a little, instead of a few chunks completely.
void Stream::request(StreamWorker::Request request) {
  request.detail = request_for(views_, loss_factor());
  const double in_time = requests_at_once * std::exchange(uploads_in_time_, 0.0);
  if (passes_ == 0 && worker_.chosen().error)
    request.detail.max_read = static_cast<std::size_t>(std::clamp(in_time, min_requested, 1e15));
  worker_.request(std::move(request));
}

bool Stream::upload_loaded(double ms) {
  const auto start = Clock::now();
  const auto most = static_cast<std::size_t>(upload_share * ms * uploads_per_ms_);
  std::vector<LodFiles::LoadedChunk> loaded_chunks = worker_.take(std::max(most, min_timed_upload));
  if (loaded_chunks.empty()) return false;
  const TimedSpan span("upload levels");
  put(loaded_chunks);
  gpu_model_->reload(chunks_.take_changes());
  std::size_t gaussians = 0;
  for (const LodFiles::LoadedChunk& loaded : loaded_chunks) gaussians += loaded.model.count();
  times_.put += gaussians;
  loaded_chunks.clear();  // the rate includes the time of destruction
  if (gaussians >= min_timed_upload)
    uploads_per_ms_ =
        std::lerp(uploads_per_ms_, static_cast<double>(gaussians) / std::max(ms_since(start), 1e-3), 0.2);
  pass_.is_outdated = true;
  return true;
}

void Stream::calibrate_at_rest(const render::FrameSettings& settings) {
  const TimedSpan span("calibrate levels");
  is_calibrated_ = is_due_ = true;
  chooser_.forget();
  LevelChoice choice = chooser_.choose(views_, request_for(views_), measure(views_, settings));
  calibrate(views_, settings, choice);
  sample_error_ = 0.0;
}

}  // namespace binosplat
