// The session, its states, and what the script lets happen to it.

#include <algorithm>

#include "xr/runtime/api.h"

namespace binosplat::xr_test {

void set_state(Session& session, XrSessionState state) {
  Runtime& r = runtime();
  session.state = state;
  r.log({{"what", "state"}, {"state", name_of(state)}, {"frame", r.frame()}});
  r.queue(XrEventDataSessionStateChanged{XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED, nullptr,
                                         handle_of<XrSession>(session), state, r.time_of(r.frame())});
}

void walk_to(Session& session, XrSessionState state) {
  const auto shown = [](XrSessionState s) {
    return s == XR_SESSION_STATE_SYNCHRONIZED || s == XR_SESSION_STATE_VISIBLE ||
           s == XR_SESSION_STATE_FOCUSED;
  };
  if (shown(state)) {
    while (session.state < state) set_state(session, static_cast<XrSessionState>(session.state + 1));
    while (session.state > state) set_state(session, static_cast<XrSessionState>(session.state - 1));
    return;
  }
  if (state == XR_SESSION_STATE_STOPPING && shown(session.state)) {
    walk_to(session, XR_SESSION_STATE_SYNCHRONIZED);
  }
  set_state(session, state);
}

namespace {

XrSessionState state_from(const std::string& name) {
  static const std::map<std::string, XrSessionState> states = {
      {"synchronized", XR_SESSION_STATE_SYNCHRONIZED},
      {"visible", XR_SESSION_STATE_VISIBLE},
      {"focused", XR_SESSION_STATE_FOCUSED},
      {"stopping", XR_SESSION_STATE_STOPPING},
      {"loss_pending", XR_SESSION_STATE_LOSS_PENDING}};
  const auto found = states.find(name);
  if (found == states.end()) throw std::runtime_error("no state of an event: " + name);
  return found->second;
}

void recentre(Session& session, int frame, const Json& pose) {
  Runtime& r = runtime();
  const Pose old = r.locals.back().second, fresh = pose_from(pose);
  r.locals.emplace_back(frame, fresh);
  r.queue(XrEventDataReferenceSpaceChangePending{XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING, nullptr,
                                                 handle_of<XrSession>(session), XR_REFERENCE_SPACE_TYPE_LOCAL,
                                                 r.time_of(frame), XR_TRUE, to_xr(inverse(old) * fresh)});
}

void change_view(Session& session, const Json& json) {
  Runtime& r = runtime();
  const auto type = configuration_from(json.value("configuration", "stereo"));
  const std::size_t index = json.at("index");
  patch(r.script.views.at(type).at(index), json);
  if (!json.contains("mask")) return;
  auto& masks = r.script.masks[type];
  masks.resize(std::max(masks.size(), index + 1));
  masks[index] = mask_from(json["mask"]);
  r.queue(XrEventDataVisibilityMaskChangedKHR{XR_TYPE_EVENT_DATA_VISIBILITY_MASK_CHANGED_KHR, nullptr,
                                              handle_of<XrSession>(session), type,
                                              static_cast<std::uint32_t>(index)});
}

void apply(Session& session, int frame, const Json& event) {
  Runtime& r = runtime();
  for (const auto& [key, value] : event.items()) {
    if (key == "frame" || key == "result" || key == "times" || key == "then" || key == "fail") continue;
    if (key == "state") {
      session.then = event.value("then", "exiting");
      walk_to(session, state_from(value));
    } else if (key == "recentre") {
      recentre(session, frame, value);
    } else if (key == "view") {
      change_view(session, value);
    } else if (key == "flags") {
      r.script.flags = flags_from(value);
    } else if (key == "instance_loss") {
      r.queue(XrEventDataInstanceLossPending{XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING, nullptr,
                                             r.time_of(frame + 1)});
    } else if (key == "input") {
      for (const auto& [path, state] : value.items()) r.input[path] = state;
    } else if (key == "gaze") {
      r.script.gaze = value.is_null() ? std::nullopt : std::optional(pose_from(value));
    } else if (key == "hands") {
      r.script.hands = value.get<std::set<std::string>>();
    } else if (key == "profile") {
      r.script.profile = value;
    } else {
      throw std::runtime_error("an event of the script has an unknown word: " + key);
    }
  }
}

}  // namespace

void apply_events(Session& session, int frame) {
  Runtime& r = runtime();
  for (; r.applied < frame; ++r.applied) {
    for (const Json& event : r.script.events) {
      if (event.value("frame", 0) == r.applied + 1) apply(session, r.applied + 1, event);
    }
  }
}

namespace api {

XrResult create_session(XrInstance handle, const XrSessionCreateInfo* info, XrSession* out) {
  Runtime& r = runtime();
  const auto& instance = r.get<Instance>(handle);
  checked(info, XR_TYPE_SESSION_CREATE_INFO);
  check_system(info->systemId);
  require(r.session() == nullptr, XR_ERROR_LIMIT_REACHED, "a second session");
  require(instance.asked_requirements, XR_ERROR_GRAPHICS_REQUIREMENTS_CALL_MISSING,
          "xrGetOpenGLGraphicsRequirementsKHR is expected before");
  Binding binding =
      binding_from(info->next, instance.extensions.count(XR_MNDX_EGL_ENABLE_EXTENSION_NAME) != 0,
                   instance.extensions.count(XR_KHR_OPENGL_ENABLE_EXTENSION_NAME) != 0);
  {
    const Current current(binding);
    const XrVersion version = version_of(binding);
    require(version >= r.script.gl_min && version <= r.script.gl_max, XR_ERROR_GRAPHICS_DEVICE_INVALID,
            "a context of a version that is not within the requirements");
  }
  auto& session = r.add<Session>(instance.id);
  session.binding = binding;
  r.log({{"what", "session"}, {"id", session.id}, {"binding", session.binding.name}});
  set_state(session, XR_SESSION_STATE_IDLE);
  set_state(session, XR_SESSION_STATE_READY);
  *out = handle_of<XrSession>(session);
  return XR_SUCCESS;
}

XrResult destroy_session(XrSession handle) {
  runtime().destroy(runtime().get<Session>(handle, true));
  return XR_SUCCESS;
}

XrResult begin_session(XrSession handle, const XrSessionBeginInfo* info) {
  Runtime& r = runtime();
  auto& session = r.get<Session>(handle);
  checked(info, XR_TYPE_SESSION_BEGIN_INFO);
  require(!session.running, XR_ERROR_SESSION_RUNNING, "the session runs already");
  require(session.state == XR_SESSION_STATE_READY, XR_ERROR_SESSION_NOT_READY,
          std::string("the state is ") + name_of(session.state));
  views_of(info->primaryViewConfigurationType);
  session.configuration = info->primaryViewConfigurationType;
  session.running = true;
  r.log({{"what", "begin"}, {"configuration", name_of(session.configuration)}});
  if (r.script.invisible_frames == 0 || r.next_frame > 0) walk_to(session, XR_SESSION_STATE_FOCUSED);
  apply_events(session, r.next_frame);
  return XR_SUCCESS;
}

XrResult end_session(XrSession handle) {
  auto& session = runtime().get<Session>(handle);
  require(session.running, XR_ERROR_SESSION_NOT_RUNNING, "the session does not run");
  require(session.state == XR_SESSION_STATE_STOPPING, XR_ERROR_SESSION_NOT_STOPPING,
          std::string("the state is ") + name_of(session.state));
  if (session.begun || session.waited) runtime().fault("a frame was not ended");
  session.running = false;
  session.begun = session.waited = std::nullopt;
  set_state(session, XR_SESSION_STATE_IDLE);
  set_state(session, session.then == "ready" ? XR_SESSION_STATE_READY : XR_SESSION_STATE_EXITING);
  return XR_SUCCESS;
}

XrResult request_exit_session(XrSession handle) {
  auto& session = runtime().get<Session>(handle);
  require(session.running, XR_ERROR_SESSION_NOT_RUNNING, "the session does not run");
  runtime().log({{"what", "exit requested"}, {"frame", runtime().frame()}});
  session.then = "exiting";
  if (session.state != XR_SESSION_STATE_STOPPING) walk_to(session, XR_SESSION_STATE_STOPPING);
  return XR_SUCCESS;
}

}  // namespace api
}  // namespace binosplat::xr_test
