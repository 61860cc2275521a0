#include "xr/headset.h"

#include <binosplat/report.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <thread>
#include <utility>

#include "base/error.h"
#include "base/log.h"
#include "base/spans.h"
#include "base/statistics.h"
#include "xr/hands.h"

namespace binosplat::xr {

namespace {

using std::chrono::milliseconds;

constexpr double own_share = 0.8;         // of a frame's time: the runtime draws, too
constexpr double eyes_above_floor = 1.6;  // m, of somebody who stands
constexpr int sessions_most = 10;         // one after the other, where they are lost
constexpr milliseconds between_sessions{500}, wait_most{10000};
constexpr XrDuration between_looks = 1'000'000'000;  // ns
constexpr milliseconds between_polls{10};            // while no frames are wanted

class Viewer {
 public:
  Viewer(const Instance& instance, std::shared_ptr<render::GpuModel> model, const HeadsetSettings& settings,
         const Beside& beside)
      : instance_(instance),
        context_(model->context()),
        settings_(settings),
        beside_(beside),
        frame_(std::move(model)) {}

  /// False where the session was lost.
  bool run_session() {
    try {
      return play_session();
    } catch (const Lost& lost) {
      if (lost.instance)
        throw Error(ExitCode::no_gl,
                    fmt::format("{} has ended: start it, and then this again", instance_.runtime()));
      return leaving_;
    }
  }

  std::size_t frames() const { return times_.size(); }

  void tell() const {
    if (times_.empty()) return log_info("no frame was drawn");
    log_info("{} frames were drawn, in {:.2f} ms of GPU time each (median), {:.1f} at most", times_.size(),
             quantile(times_, 0.5), quantile(times_, 1.0));
  }

 private:
  /// Until it is over. Throws Lost.
  bool play_session() {
    Session session(instance_);
    Hands hands(session);
    std::unique_ptr<Projection> projection = make_projection(session);
    frame_.frame().start_over();
    last_.reset();
    while (session.poll()) {
      if (session.running()) draw(session, hands, projection);
      if (!beside_.step() && !leaving_) {
        leaving_ = true;
        session.request_exit();
      }
      if (!session.running()) std::this_thread::sleep_for(between_polls);
    }
    return true;
  }

  /// A frame of the runtime's.
  void draw(Session& session, Hands& hands, std::unique_ptr<Projection>& projection) {
    const FrameTime time = session.begin_frame();
    const auto began = Clock::now();
    const std::vector<XrView> views = time.is_shown ? session.locate(time.display) : std::vector<XrView>();
    if (time.is_shown && views.empty() && tracked_) log_info("the head is not tracked: nothing is shown");
    if (time.is_shown) tracked_ = !views.empty();
    if (views.empty()) {
      last_.reset();
      if (shown_) shown_->last = time.display;  // which was not missed: nothing was to be drawn
      return session.end_frame(time, nullptr);
    }
    if (session.take_recentred(time.display)) frame_.frame().forget();
    if (time.display - looked_ >= between_looks) {
      looked_ = time.display;
      if (projection->outdated()) {
        projection.reset();  // its memory first
        projection = make_projection(session);
      }
    }
    if (session.take_masks_changed()) projection->take_masks();
    follow(session, hands, views, time);
    const double period_ms = 1e-6 * static_cast<double>(time.period);
    render::FrameRecord record{.due = began, .begin = began};
    float left = 0.0f;
    {
      const TimedSpan span("levels", &record.levels.ms);
      left = follow_levels(period_ms);
    }
    if (settings_.budget_ms && !budget_) {
      budget_.emplace(*settings_.budget_ms > 0.0 ? *settings_.budget_ms : own_share * period_ms);
    }
    const Effort effort = budget_ ? budget_->effort() : Effort{left, 1.0};
    render::FrameSettings settings = settings_.frame;
    settings.quality = effort.quality.value_or(0.0f);
    if (budget_ && effort.quality) settings.th = TH_SQUARED;
    const std::optional<XrPosef> gaze =
        settings_.projection.foveation ? hands.gaze(time.display) : std::nullopt;
    record.report = projection->draw(frame_, views, walk_->placement(), settings,
                                     {.scale = effort.scale, .gaze = gaze, .drawn_left = beside_.show});
    times_.push_back(record.report.total_ms);
    if (budget_) budget_->took(record.report.total_ms, period_ms);
    session.end_frame(time, projection->layer());
    tell_drawn(std::move(record), time);
  }

  /// Tells of a frame that the runtime has, and of the times at which it shows frames.
  void tell_drawn(render::FrameRecord record, const FrameTime& time) {
    record.end = Clock::now();
    record.views.assign(frame_.frame().views().begin(),
                        frame_.frame().views().begin() + frame_.frame().plan().asked);
    record.gaussians = frame_.frame().model()->size().gaussians;
    if (!shown_) shown_ = {time.display, time.display};
    const auto periods = std::llround(static_cast<double>(time.display - shown_->last) /
                                      static_cast<double>(std::max<XrDuration>(time.period, 1)));
    record.display = {1e-6 * static_cast<double>(time.display - shown_->first),
                      static_cast<int>(std::max(periods - 1, 0LL))};
    shown_->last = time.display;
    if (beside_.drawn) beside_.drawn(std::move(record), 1e-6 * static_cast<double>(time.period));
  }

  std::unique_ptr<Projection> make_projection(const Session& session) const {
    auto projection = std::make_unique<Projection>(session, context_, settings_.projection);
    projection->take_masks();
    log_info("{}: {}", instance_.headset(), projection->description());
    return projection;
  }

  /// To where hands take the head.
  void follow(const Session& session, Hands& hands, const std::vector<XrView>& views, const FrameTime& time) {
    const InputActions actions = hands.read(time.display);
    const Eye left = eye_of(views[0].pose), right = eye_of(views[1].pose);
    Eye head = left;  // between both eyes, which may be canted
    head.position = 0.5 * (left.position + right.position);
    head.orientation =
        left.orientation + glm::sign(glm::dot(left.orientation, right.orientation)) * right.orientation;
    if (!walk_) walk_.emplace(start_of(settings_, session.on_floor(), session.on_stage() ? &head : nullptr));
    if (actions.resets) walk_->reset();
    if (last_) walk_->step(head, actions.hands, 1e-9 * static_cast<double>(time.display - *last_));
    last_ = time.display;
  }

  /// By what the last frame's views need. Returns what is left of the quality that a frame is to have.
  float follow_levels(double period_ms) {
    const render::Frame& frame = frame_.frame();
    if (!beside_.levels || frame.views().empty()) return settings_.frame.quality;
    const auto views = std::span(frame.views()).first(frame.plan().asked);
    return beside_.levels(views, period_ms, times_.back());
  }

  const Instance& instance_;
  gl::Context& context_;
  const HeadsetSettings& settings_;
  const Beside& beside_;
  stereo::FoveatedFrame frame_;
  std::optional<Walk> walk_;  // goes on where a session is lost
  std::optional<FrameBudget> budget_;
  std::optional<XrTime> last_;  // when the last frame was seen
  /// When the first and the last frame were shown that were drawn.
  struct Shown {
    XrTime first = 0, last = 0;
  };
  std::optional<Shown> shown_;
  XrTime looked_ = 0;          // when it was asked which sizes the runtime recommends
  std::vector<double> times_;  // ms
  bool tracked_ = true, leaving_ = false;
};

}  // namespace

Placement start_of(const HeadsetSettings& settings, bool on_floor, const Eye* head) {
  const glm::dvec3 up = glm::normalize(settings.up);
  const Camera& start = settings.start;
  glm::dvec3 forward = start.rotation[2] - glm::dot(start.rotation[2], up) * up;
  // Straight up or down: where its upper edge points.
  if (glm::length(forward) < 1e-3) forward = -start.rotation[1] + glm::dot(start.rotation[1], up) * up;
  forward = glm::normalize(forward);
  Placement placement;
  placement.axes = glm::dmat3(glm::cross(forward, up), up, -forward);
  placement.units_per_metre = settings.units_per_metre;
  placement.origin = start.position;
  if (on_floor) placement.origin -= eyes_above_floor * settings.units_per_metre * up;
  if (head == nullptr) return placement;
  const glm::dvec3 ahead = heading_of(*head);
  const double turned = std::atan2(-ahead.x, -ahead.z);  // to the left
  placement.axes *= glm::mat3_cast(glm::angleAxis(-turned, glm::dvec3(0.0, 1.0, 0.0)));
  placement.origin -=
      settings.units_per_metre * (placement.axes * glm::dvec3(head->position.x, 0.0, head->position.z));
  return placement;
}

void run(Instance& instance, std::shared_ptr<render::GpuModel> model, const HeadsetSettings& settings,
         const Beside& beside) {
  Viewer viewer(instance, std::move(model), settings, beside);
  std::size_t drawn = 0;
  for (int in_vain = 0; !viewer.run_session();) {
    in_vain = viewer.frames() > drawn ? 0 : in_vain + 1;
    drawn = viewer.frames();
    if (in_vain == sessions_most)
      throw Error(ExitCode::no_gl, fmt::format("{} loses every session", instance.runtime()));
    log_warning("{} lost the session: it is begun again", instance.runtime());
    std::this_thread::sleep_for(between_sessions);
    if (!beside.step()) break;
    for (auto waited = between_sessions; !instance.find_again(); waited += between_sessions) {
      if (!beside.step()) return viewer.tell();
      if (waited > wait_most)
        throw Error(ExitCode::no_gl,
                    fmt::format("{} lost the headset: connect it and switch it on", instance.runtime()));
      std::this_thread::sleep_for(between_sessions);
    }
  }
  viewer.tell();
}

}  // namespace binosplat::xr
