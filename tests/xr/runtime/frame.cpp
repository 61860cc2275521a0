// Frames: waited for, begun, ended.

#include <algorithm>
#include <chrono>
#include <thread>

#include "xr/runtime/api.h"

namespace binosplat::xr_test::api {
namespace {

// A program that does not stop when it is asked to must not hang the tests.
constexpr int patience = 100;

void check_running(const Session& session) {
  require(session.running, XR_ERROR_SESSION_NOT_RUNNING, "the session does not run");
}

bool is_shown(const Session& session) {
  return session.state == XR_SESSION_STATE_VISIBLE || session.state == XR_SESSION_STATE_FOCUSED;
}

/// The states by which a session begins where the script lets frames be invisible.
void show_slowly(Session& session, int ended) {
  const int invisible = runtime().script.invisible_frames;
  if (ended >= invisible && session.state < XR_SESSION_STATE_VISIBLE) {
    walk_to(session, XR_SESSION_STATE_FOCUSED);
  } else if (session.state == XR_SESSION_STATE_READY) {
    walk_to(session, XR_SESSION_STATE_SYNCHRONIZED);
  }
}

void finish(Session& session, const FrameRecord& frame, Json& line) {
  Runtime& r = runtime();
  line["faults"] = frame.faults;
  session.begun.reset();
  r.ended_frames++;
  r.log(line);
  if (r.ended_frames <= r.script.invisible_frames) show_slowly(session, r.ended_frames);
  apply_events(session, frame.number + 1);
  if (r.ended_frames >= r.script.frames && session.state < XR_SESSION_STATE_STOPPING) {
    session.then = "exiting";
    walk_to(session, XR_SESSION_STATE_STOPPING);
  }
}

}  // namespace

XrResult wait_frame(XrSession handle, const XrFrameWaitInfo* info, XrFrameState* state) {
  Runtime& r = runtime();
  auto& session = r.get<Session>(handle);
  check_if_any(info, XR_TYPE_FRAME_WAIT_INFO);
  checked(state, XR_TYPE_FRAME_STATE);
  check_running(session);
  require(!session.waited, XR_ERROR_CALL_ORDER_INVALID,
          "the frame before was not begun: this would wait for ever");
  if (r.next_frame >= r.script.frames + patience) {
    session.lost = true;
    refuse(XR_ERROR_SESSION_LOST, "the application does not stop");
  }
  FrameRecord frame;
  frame.number = r.next_frame++;
  apply_events(session, frame.number);
  const auto late = std::distance(r.script.late.begin(), r.script.late.upper_bound(frame.number));
  frame.time = r.time_of(frame.number) + late * r.script.period;
  frame.should_render = is_shown(session) && r.script.not_rendered.count(frame.number) == 0;
  state->predictedDisplayTime = frame.time;
  state->predictedDisplayPeriod = r.script.period;
  state->shouldRender = frame.should_render ? XR_TRUE : XR_FALSE;
  session.waited = frame;
  if (r.script.sleep) {
    r.mutex.unlock();  // other threads may end a frame meanwhile
    std::this_thread::sleep_for(std::chrono::nanoseconds(r.script.period));
    r.mutex.lock();
  }
  return session.state == XR_SESSION_STATE_LOSS_PENDING ? XR_SESSION_LOSS_PENDING : XR_SUCCESS;
}

XrResult begin_frame(XrSession handle, const XrFrameBeginInfo* info) {
  Runtime& r = runtime();
  auto& session = r.get<Session>(handle);
  check_if_any(info, XR_TYPE_FRAME_BEGIN_INFO);
  check_running(session);
  require(session.waited.has_value(), XR_ERROR_CALL_ORDER_INVALID, "xrWaitFrame is expected before");
  const bool discards = session.begun.has_value();
  if (discards) r.fault("the frame before was not ended", XR_FRAME_DISCARDED);
  session.begun = session.waited;
  session.waited.reset();
  return discards ? XR_FRAME_DISCARDED : XR_SUCCESS;
}

XrResult end_frame(XrSession handle, const XrFrameEndInfo* info) {
  Runtime& r = runtime();
  auto& session = r.get<Session>(handle);
  checked(info, XR_TYPE_FRAME_END_INFO);
  check_running(session);
  require(session.begun.has_value(), XR_ERROR_CALL_ORDER_INVALID, "xrBeginFrame is expected before");
  FrameRecord& frame = *session.begun;
  Json line = {{"what", "frame"},
               {"frame", frame.number},
               {"time", frame.time},
               {"should_render", frame.should_render},
               {"state", name_of(session.state)}};
  Json& located = line["located"] = Json::array();
  for (const Located& one : frame.located) {
    Json views = Json::array();
    for (const XrView& view : one.views)
      views.push_back({{"pose", to_json(view.pose)}, {"fov", to_json(view.fov)}});
    located.push_back({{"space", one.space}, {"flags", one.flags}, {"views", views}});
  }
  line["head"] = to_json(
      to_xr(r.script.heads[std::min(static_cast<std::size_t>(frame.number), r.script.heads.size() - 1)]));
  try {
    require(info->displayTime > 0, XR_ERROR_TIME_INVALID, "no display time");
    require(info->displayTime == frame.time, XR_ERROR_TIME_INVALID,
            "display time " + std::to_string(info->displayTime) + " where " + std::to_string(frame.time) +
                " was predicted");
    require(info->environmentBlendMode == XR_ENVIRONMENT_BLEND_MODE_OPAQUE,
            XR_ERROR_ENVIRONMENT_BLEND_MODE_UNSUPPORTED,
            "blend mode " + std::to_string(info->environmentBlendMode));
    for (const auto& [id, object] : r.objects) {
      const auto* swapchain = dynamic_cast<const Swapchain*>(object.get());
      if (swapchain != nullptr && !swapchain->acquired.empty()) {
        r.fault("an image of swapchain " + std::to_string(id) + " was not released");
      }
    }
    check_layers(session, frame, *info, line);
  } catch (const Refusal& refusal) {
    r.fault(refusal.text, refusal.result);
    line["result"] = name_of(refusal.result);
    finish(session, frame, line);
    return refusal.result;
  }
  finish(session, frame, line);
  return session.state == XR_SESSION_STATE_LOSS_PENDING ? XR_SESSION_LOSS_PENDING : XR_SUCCESS;
}

}  // namespace binosplat::xr_test::api
