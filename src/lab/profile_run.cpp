#include "lab/profile_run.h"

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "base/statistics.h"
#include "lab/times.h"

namespace binosplat::lab {

namespace {

constexpr double busy_ms = 1000.0;           // time for a GPU to raise its clock
constexpr double levels_wait_ms = 10'000.0;  // longest wait for the levels of the first frame
constexpr double usual_frame_ms = 1000.0 / 90.0;
constexpr double slow_ms = 300.0;  // saving() skips slower frames

/// Sleeps until shortly before `due`, then polls the clock.
void wait_until(Clock::time_point due) {
  constexpr std::chrono::milliseconds late_by_sleeping{1};
  std::this_thread::sleep_until(due - late_by_sleeping);
  while (Clock::now() < due) std::this_thread::yield();
}

}  // namespace

ProfileDrawer::ProfileDrawer(std::shared_ptr<render::GpuModel> model, const ProfileInput& run, Stream* stream)
    : run_(run),
      stream_(stream),
      context_(model->context()),
      drawing_(std::move(model)),
      clock_(run.asks_clock ? std::make_shared<gl::GpuClock>(context_) : nullptr) {}

render::FrameSettings ProfileDrawer::settings_now() const {
  render::FrameSettings settings = run_.settings;
  if (stream_ != nullptr) settings.quality = stream_->frame_quality(settings.quality);
  return settings;
}

render::FrameLevels ProfileDrawer::follow_levels(std::span<const shared::View> views, double drawn_ms) {
  render::FrameLevels levels;
  if (stream_ == nullptr) return levels;
  const TimedSpan span("levels", &levels.ms);
  const double period_ms = run_.fps > 0.0 ? 1000.0 / run_.fps : usual_frame_ms;
  stream_->begin_frame(views, run_.settings, time_for_levels(period_ms, drawn_ms));
  levels.uploaded = stream_->take_times().put;
  return levels;
}

double ProfileDrawer::warm_up() {
  const std::vector<shared::View>& first = run_.frames.front();
  const auto begin = Clock::now();
  double ms = 0.0;
  const auto draw_first = [&] {
    const auto frame_begin = Clock::now();
    drawing_.draw(first, settings_now());
    ms = ms_since(frame_begin);
  };
  for (int n = 0; n < 2; ++n) draw_first();
  if (stream_ != nullptr) {
    do follow_levels(first, ms);
    while (!stream_->settled() && ms_since(begin) < levels_wait_ms);
    draw_first();
  }
  gl::raise_clock(context_, busy_ms, draw_first);
  drawing_.frame().start_over();
  return ms;
}

render::Recording ProfileDrawer::record(const std::function<void(std::size_t)>& progress) {
  render::Recorder recorder(context_, run_.fps, clock_);
  const std::chrono::duration<double> period(run_.fps > 0.0 ? 1.0 / run_.fps : 0.0);
  const Clock::time_point start = Clock::now();
  double ticks = 0.0, drawn_ms = 0.0;
  for (std::size_t n = 0; n < run_.frames.size(); ++n) {
    render::FrameRecord frame{.due = Clock::now(), .views = run_.frames[n]};
    if (run_.fps > 0.0) {
      // The next multiple of the period. Multiples that passed during the last frame are skipped.
      if (n > 0) ticks = std::max(ticks, std::ceil((Clock::now() - start) / period));
      frame.due = start + std::chrono::duration_cast<Clock::duration>(ticks * period);
      wait_until(frame.due);
      ticks += 1.0;
    }
    const CpuUse before = CpuUse::now(context_);  // takes time, so it precedes frame.begin
    frame.begin = Clock::now();
    frame.levels = follow_levels(frame.views, drawn_ms);
    frame.report = drawing_.draw(frame.views, settings_now());
    frame.end = Clock::now();
    if (context_.software()) cpu_.push_back(CpuUse::now(context_).since(before));
    frame.gaussians = stream_ != nullptr ? stream_->gaussians() : drawing_.frame().model()->size().gaussians;
    drawn_ms = frame.report.gpu_ms;
    recorder.add(std::move(frame));
    progress(n + 1);
  }
  return recorder.finish();
}

Image ProfileDrawer::picture(std::size_t frame) {
  drawing_.draw(run_.frames[frame], settings_now());
  return for_page(
      composite(drawing_.read_pictures().front(), run_.settings.background.value_or(glm::vec3(0.0f))),
      worst_picture_width);
}

std::optional<Saving> ProfileDrawer::saving(std::size_t frame, double quality_db) {
  const std::vector<shared::View>& views = run_.frames[frame];
  if (!render::is_exact(render::chosen_threshold(run_.settings)) || run_.settings.foveation)
    return std::nullopt;
  render::FrameSettings less = run_.settings;
  less.threshold.reset();  // as --quality alone draws
  less.quality = static_cast<float>(quality_db);
  // Raise the clock first; otherwise later frames seem faster.
  if (!context_.software()) gl::raise_clock(context_, busy_ms, [&] { drawing_.draw(views, run_.settings); });
  std::vector<double> before, after;
  if (drawing_.draw(views, run_.settings).gpu_ms > slow_ms) return std::nullopt;
  for (int n = 0; n < (context_.software() ? 4 : 16); ++n)
    before.push_back(drawing_.draw(views, run_.settings).gpu_ms);
  // The first frames are exact, because their error is unknown.
  for (int n = 0; n < render::settling_frames; ++n) drawing_.draw(views, less);
  for (int n = 0; n < (context_.software() ? 4 : 16); ++n) after.push_back(drawing_.draw(views, less).gpu_ms);
  return Saving{quality_db, 1.0 - mean(after) / quantile(before, 0.5)};
}

}  // namespace binosplat::lab
