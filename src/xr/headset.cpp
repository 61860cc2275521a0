#include "xr/headset.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include "base/log.h"
#include "base/statistics.h"
#include "base/thread_spans.h"
#include "xr/hands.h"
#include "xr/projection_layer.h"

namespace binosplat::xr {

namespace {

using std::chrono::milliseconds;

constexpr double own_share = 0.8;  // our share of a frame's time, because the runtime also draws
// The viewer ends after this many lost sessions in a row in which it drew no frame.
constexpr int max_sessions = 10;
constexpr milliseconds between_sessions{500}, max_wait{10000};
constexpr milliseconds between_polls{10};  // while the runtime requests no frames

double ms_of(XrDuration ns) { return 1e-6 * static_cast<double>(ns); }

// The head's pose: midway between both eyes, which may be canted.
Eye head_of(const std::vector<XrView>& views) {
  const Eye left = eye_of(views[0].pose), right = eye_of(views[1].pose);
  const double same_way = glm::sign(glm::dot(left.orientation, right.orientation));
  return {0.5 * (left.position + right.position), left.orientation + same_way * right.orientation};
}

class Viewer {
 public:
  Viewer(const Instance& instance, Renderer& renderer, const HeadsetSettings& settings,
         const Callbacks& callbacks)
      : instance_(instance), renderer_(renderer), settings_(settings), callbacks_(callbacks) {}

  /// Runs a session to its end. Returns false if the session was lost.
  bool run_session() try {
    Session session(instance_);
    Hands hands(session);
    ProjectionLayer projection(session, settings_.scale,
                               settings_.drawing.foveation && !instance_.has_insets());
    log_info("{}: {}", instance_.headset, projection.description());
    last_.reset();
    while (session.poll()) {
      if (session.running()) draw(session, hands, projection);
      if (!callbacks_.step() && !leaving_) {
        leaving_ = true;
        session.request_exit();
      }
      if (!session.running()) std::this_thread::sleep_for(between_polls);
    }
    return true;
  } catch (const Lost& lost) {
    if (lost.instance) refuse("{} has ended: start it, then start binosplat again", instance_.runtime);
    return leaving_;
  }

  std::size_t frames() const { return times_.size(); }

  void tell() const {
    if (times_.empty()) return log_info("no frame was drawn");
    log_info("{} frames were drawn, in {:.2f} ms of GPU time each (median), {:.1f} at most", times_.size(),
             quantile(times_, 0.5), quantile(times_, 1.0));
  }

 private:
  void draw(Session& session, Hands& hands, ProjectionLayer& projection) {
    const XrFrameState wanted = session.begin_frame();
    const XrTime display = wanted.predictedDisplayTime;
    Drawn frame{.begin = Clock::now(), .period_ms = ms_of(wanted.predictedDisplayPeriod)};
    std::vector<XrView> views;
    if (wanted.shouldRender) {
      views = session.locate(display);
      if (views.empty() && tracked_) log_info("the head is not tracked: nothing is shown");
      tracked_ = !views.empty();
    }
    if (views.empty()) {
      last_.reset();
      last_shown_ = display;  // no periods are missed, because the runtime requested no picture
      return session.end_frame(display);
    }
    if (session.take_masks_changed()) projection.take_masks();
    const Input input = hands.read(display);
    walk(session, input, head_of(views), display);
    if (settings_.budget_ms && !budget_)
      budget_.emplace(*settings_.budget_ms > 0.0 ? *settings_.budget_ms : own_share * frame.period_ms);
    const Effort effort = budget_ ? budget_->effort() : Effort{settings_.drawing.quality};
    Settings drawing = settings_.drawing;
    drawing.quality = effort.quality;
    drawing.depth = DepthKind::median;
    if (instance_.has_insets()) drawing.foveation.reset();
    if (drawing.foveation && input.gaze) drawing.foveation->gaze = gaze_of(*input.gaze, views);
    // If the hands enlarge the world, the near plane keeps its distance from the eyes in metres.
    const Placement& placement = walk_->placement();
    drawing.near_plane = drawing.near_plane.value_or(near_default) *
                         std::min(1.0, placement.units_per_metre / settings_.start.units_per_metre);
    frame.views = projection.begin(views, placement, effort.scale, drawing);
    if (callbacks_.levels) {
      const TimedSpan span("levels", &frame.levels_ms);
      const double drawn_ms = times_.empty() ? 0.0 : times_.back();
      callbacks_.levels(frame.views, placement, drawing, frame.period_ms, drawn_ms);
    }
    if (settings_.calibration) drawing = settings_.calibration->settings(frame.views, placement, drawing);
    frame.report = renderer_.draw(frame.views, placement, drawing);
    times_.push_back(frame.report.gpu_ms);
    if (budget_) budget_->took(frame.report, frame.period_ms);
    const View& left = frame.views[instance_.has_insets() ? 1 : 0];
    if (callbacks_.show) callbacks_.show(left.target, left.size);
    projection.end(display, views, frame.views, placement);
    tell_drawn(std::move(frame), display);
  }

  void tell_drawn(Drawn frame, XrTime display) {
    frame.end = Clock::now();
    if (first_shown_ == 0) first_shown_ = last_shown_ = display;
    const auto periods = std::llround(ms_of(display - last_shown_) / std::max(frame.period_ms, 1e-6));
    frame.display_ms = ms_of(display - first_shown_);
    frame.missed = static_cast<int>(std::max(periods - 1, 0LL));
    last_shown_ = display;
    callbacks_.drawn(std::move(frame));
  }

  void walk(const Session& session, const Input& input, const Eye& head, XrTime display) {
    if (!walk_)
      walk_.emplace(start_of(settings_.start, session.on_floor(), session.on_stage() ? &head : nullptr));
    if (input.resets) walk_->reset();
    if (last_) walk_->step(head, input.hands, 1e-3 * ms_of(display - *last_));
    last_ = display;
  }

  const Instance& instance_;
  Renderer& renderer_;
  const HeadsetSettings& settings_;
  const Callbacks& callbacks_;
  std::optional<Walk> walk_;  // continues after a lost session
  std::optional<FrameBudget> budget_;
  std::optional<XrTime> last_;               // display time of the last step of `walk_`
  XrTime first_shown_ = 0, last_shown_ = 0;  // display times of drawn frames; 0: none yet
  std::vector<double> times_;                // GPU time of each frame, ms
  bool tracked_ = true, leaving_ = false;
};

}  // namespace

void run(Instance& instance, Renderer& renderer, const HeadsetSettings& settings,
         const Callbacks& callbacks) {
  Viewer viewer(instance, renderer, settings, callbacks);
  std::size_t drawn = 0;
  for (int in_vain = 0; !viewer.run_session();) {
    in_vain = viewer.frames() > drawn ? 0 : in_vain + 1;
    drawn = viewer.frames();
    if (in_vain == max_sessions)
      refuse("{} lost {} sessions in a row: restart it", instance.runtime, in_vain);
    log_warning("{} lost the session: starting another one", instance.runtime);
    auto waited = milliseconds(0);
    do {
      std::this_thread::sleep_for(between_sessions);
      if (!callbacks.step()) return viewer.tell();
      waited += between_sessions;
      if (waited > max_wait) refuse("{} lost the headset: connect it and switch it on", instance.runtime);
    } while (XR_FAILED(instance.find_headset()));
  }
  viewer.tell();
}

}  // namespace binosplat::xr
