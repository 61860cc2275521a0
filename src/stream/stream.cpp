#include "stream/stream.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace binosplat {

namespace {

constexpr double between_passes_ms = 100.0;
constexpr int passes_most = 3;  // at the same views: after them a choice hardly changes any more
// Of a frame's time for levels what copying may take: uploading takes as long.
constexpr double copying_share = 0.5;
constexpr std::size_t put_at_once = 1 << 14;  // Gaussians, before the time is looked at
// A request goes on while the next one is made, which takes as long as from one to the next; and it has so
// many Gaussians, however few frames there were.
constexpr double requests_at_once = 2.0, requested_least = 1 << 14;
// Of a frame's time, ms: what is neither drawing nor levels.
constexpr double apart_ms = 1.2;

bool same(std::span<const shared::View> a, std::span<const shared::View> b) {
  return std::ranges::equal(std::as_bytes(a), std::as_bytes(b));
}

}  // namespace

double time_for_levels(double frame_ms, double drawn_ms) {
  return std::clamp(frame_ms - drawn_ms - apart_ms, 2.5, levels_ms_most);
}

Stream::Stream(const std::filesystem::path& path, StreamSettings settings)
    : settings_(std::move(settings)),
      files_(path),
      model_(files_.like()),
      chunks_(files_.chunks().size() + 1),
      chooser_(files_) {
  files_.check(settings_.detail);
  const std::size_t most = request_for({}).most, finest = files_.finest();
  shows_all_ = finest <= std::min(settings_.all_up_to, most);
  if (settings_.reserve > 0) {
    model_.room = std::min(finest, most < finest ? most : settings_.reserve) + files_.spare();
    // Touched now: the system gives memory a page at a time, and slowly while others decode (10 ms a frame).
    model_.reserve(model_.room);
    model_.resize(std::min(model_.room, settings_.reserve));
  }
  start_over();
  bring_to(chooser_.choose({}, {}, {}));
}

std::shared_ptr<render::GpuModel> Stream::gpu_model(gl::Context& context, int precision) {
  if (!gpu_model_) gpu_model_ = std::make_shared<render::GpuModel>(context, model_, precision);
  return gpu_model_;
}

std::optional<double> Stream::db_for(double quality) const {
  if (shows_all_) return std::nullopt;
  if (settings_.shares && quality > 0.0 && files_.has_errors()) return levels_share(quality);
  return settings_.detail.db;
}

DetailRequest Stream::request_for(std::span<const shared::View> views) const {
  DetailRequest request = settings_.detail;
  request.db = db_for(quality_);
  request.calibration = calibration_.to_choose_by();
  if (settings_.room) {
    const std::size_t fit = settings_.room(views, model_.degree);
    request.most = std::min(request.most, fit - std::min(fit, files_.spare()));
  }
  return request;
}

double Stream::quality_left(double together_db) const {
  const auto levels_db = db_for(together_db);
  return together_db > 0.0 && levels_db ? left_of(together_db, *levels_db) : together_db;
}

std::optional<double> Stream::reported_db() const {
  const auto error = worker_ ? worker_->error() : error_;
  if (!error) return std::nullopt;
  error->follow(drawn_);
  return reported(error->error());
}

double Stream::reported(double error) const {
  return psnr_of_error(std::max(calibration_.factor() * error, sample_error_));
}

bool Stream::begin_frame(std::span<const shared::View> views, const render::FrameSettings& settings,
                         double ms) {
  if (views.empty()) return false;
  if (!worker_) {
    worker_ = std::make_unique<StreamWorker>(files_, drawn_);
    calibration_ = {};
    sample_error_ = 0.0;
    views_.clear();
  }
  worker_->check();
  if (!same(views, views_) || settings.quality != quality_) {
    if (views.size() != views_.size() || settings.quality != quality_) pass_.views.clear();
    views_.assign(views.begin(), views.end());
    quality_ = settings.quality;
    passes_ = 0;
    is_due_ = true;
  }
  is_due_ = is_due_ || needs_another_pass();
  if (is_due_ && !db_for(quality_)) {
    request(views_, {});
    is_due_ = false;
  }
  could_put_ += copying_share * ms * put_a_ms_;
  const bool made_pass = std::exchange(made_pass_, false), is_due = pass_is_due();
  // For both no frame has time: they take turns.
  if ((!is_due || made_pass) && put_some(ms)) return true;
  if (is_due) make_pass(settings);
  return false;
}

bool Stream::settled() const {
  return !worker_ || (worker_->is_idle() && !is_due_ && pass_.views.empty() && !needs_another_pass());
}

// Coarse chunks hide what fine ones do not.
bool Stream::needs_another_pass() const {
  return db_for(quality_) && worker_->is_idle() &&
         (worker_->is_limited() || (pass_.is_outdated && passes_ < passes_most));
}

bool Stream::pass_is_due() const {
  if (!db_for(quality_)) return false;
  const bool waits = pass_.began && ms_since(*pass_.began) < between_passes_ms;
  return !pass_.views.empty() || (is_due_ && !waits);
}

// At one more of the views, each as it is by then.
void Stream::make_pass(const render::FrameSettings& settings) {
  if (!visibility_) visibility_.emplace(gpu_model_);
  if (pass_.views.empty()) pass_ = {.began = Clock::now()};
  const shared::View view = views_[pass_.views.size()];
  pass_.views.push_back(view);
  pass_.visible.by_view.push_back(std::move(visibility_->measure({&view, 1}, settings, chunks_).front()));
  made_pass_ = true;
  if (pass_.views.size() < views_.size()) return;
  is_due_ = !same(pass_.views, views_);
  pass_.visible.drawn = drawn_;
  request(std::exchange(pass_.views, {}), std::move(pass_.visible));
  ++passes_;
}

// While a head moves no more is requested than frames can take in time: then all that is seen gets better by
// a little, before some of it has all that it needs.
void Stream::request(std::vector<shared::View> views, VisibleChunks visible) {
  DetailRequest detail = request_for(views);
  const double in_time = requests_at_once * std::exchange(could_put_, 0.0);
  if (passes_ == 0 && worker_->error())
    detail.most_new = static_cast<std::size_t>(std::clamp(in_time, requested_least, 1e15));
  worker_->request({std::move(views), detail, std::move(visible)});
}

bool Stream::put_some(double ms) {
  const auto start = Clock::now();
  std::size_t gaussians = 0;
  bool has_any = false;
  double took_ms = 0.0;
  do {
    const std::vector<LodFiles::Piece> pieces = worker_->take(put_at_once);
    if (pieces.empty()) break;
    put(pieces);
    for (const LodFiles::Piece& piece : pieces) gaussians += piece.model.count();
    has_any = true;
    took_ms = ms_since(start);
  } while (took_ms < copying_share * ms);
  if (!has_any) return false;
  if (gaussians >= put_at_once)
    put_a_ms_ = std::lerp(put_a_ms_, static_cast<double>(gaussians) / took_ms, 0.1);
  gpu_model_->reload(chunks_.take_changes());
  pass_.is_outdated = true;
  return true;
}

void Stream::put(std::span<const LodFiles::Piece> pieces) {
  std::vector<ModelChunks::Replacement> replacements;
  for (const LodFiles::Piece& piece : pieces) {
    replacements.push_back({piece.chunk, &piece.model});
    drawn_[piece.chunk] = piece.level;
  }
  chunks_.replace(model_, replacements);
}

}  // namespace binosplat
