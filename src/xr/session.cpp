#include "xr/session.h"

#include <openxr/openxr_reflection.h>

#include <algorithm>

#include "base/error.h"
#include "base/log.h"
#include "xr/binding.h"

namespace binosplat::xr {

namespace {

// Of XR_EXT_local_floor, which Debian 12's headers do not know yet.
constexpr auto local_floor = static_cast<XrReferenceSpaceType>(1000426000);

const char* name_of_state(XrSessionState state) {
  switch (state) {
#define BINOSPLAT_XR_NAME(name, value) \
  case name:                           \
    return #name;
    XR_LIST_ENUM_XrSessionState(BINOSPLAT_XR_NAME)
#undef BINOSPLAT_XR_NAME
        default : return "a state of its own";
  }
}

}  // namespace

Session::Session(const Instance& instance) : instance_(instance), api_(instance.api()) {
  const auto binding = binding_of_current_context(instance);
  XrSessionCreateInfo info{XR_TYPE_SESSION_CREATE_INFO};
  info.next = binding.get();
  info.systemId = instance.system();
  const XrResult result = api_.CreateSession(instance.handle(), &info, &session_);
  if (result == XR_ERROR_GRAPHICS_DEVICE_INVALID)
    throw Error(
        ExitCode::no_gl,
        fmt::format("{} does not take this OpenGL context ({}): some runtimes want the GPU that the headset "
                    "is connected to (--device), SteamVR on Linux may take none at all",
                    instance.runtime(), name_of(result)));
  check(result, "xrCreateSession");
  try {
    make_space();
    blend_mode_ = instance.blend_mode();
  } catch (...) {
    api_.DestroySession(session_);
    throw;
  }
}

Session::~Session() {
  if (space_ != XR_NULL_HANDLE) api_.DestroySpace(space_);
  api_.DestroySession(session_);
}

void Session::make_space() {
  const auto spaces = all_of<XrReferenceSpaceType>(
      "xrEnumerateReferenceSpaces", {}, [&](std::uint32_t room, std::uint32_t* count, auto* all) {
        return api_.EnumerateReferenceSpaces(session_, room, count, all);
      });
  XrReferenceSpaceCreateInfo info{XR_TYPE_REFERENCE_SPACE_CREATE_INFO};
  info.poseInReferenceSpace = no_move;
  info.referenceSpaceType = XR_REFERENCE_SPACE_TYPE_LOCAL;  // every runtime has it
  for (const XrReferenceSpaceType type : {local_floor, XR_REFERENCE_SPACE_TYPE_STAGE}) {
    on_floor_ = std::find(spaces.begin(), spaces.end(), type) != spaces.end();
    if (!on_floor_) continue;
    info.referenceSpaceType = type;
    on_stage_ = type == XR_REFERENCE_SPACE_TYPE_STAGE;
    break;
  }
  check(api_.CreateReferenceSpace(session_, &info, &space_), "xrCreateReferenceSpace");
}

bool Session::poll() {
  while (!over_) {
    XrEventDataBuffer event{XR_TYPE_EVENT_DATA_BUFFER};
    const XrResult result = api_.PollEvent(instance_.handle(), &event);
    if (result == XR_EVENT_UNAVAILABLE) break;
    check(result, "xrPollEvent");
    switch (event.type) {
      case XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED:
        follow(reinterpret_cast<const XrEventDataSessionStateChanged&>(event));
        break;
      case XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING:
        throw Lost{.instance = true};
      case XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING:
        changes_at_ = reinterpret_cast<const XrEventDataReferenceSpaceChangePending&>(event).changeTime;
        break;
      case XR_TYPE_EVENT_DATA_VISIBILITY_MASK_CHANGED_KHR:
        masks_changed_ = true;
        break;
      case XR_TYPE_EVENT_DATA_EVENTS_LOST:
        log_warning("{} lost events", instance_.runtime());
        break;
      default:
        break;  // of no interest
    }
  }
  return !over_;
}

void Session::follow(const XrEventDataSessionStateChanged& event) {
  if (event.session != session_) return;
  state_ = event.state;
  log_info("headset: {}", name_of_state(state_));
  switch (state_) {
    case XR_SESSION_STATE_READY:
      begin();
      break;
    case XR_SESSION_STATE_STOPPING:
      running_ = false;
      check(api_.EndSession(session_), "xrEndSession");
      break;
    case XR_SESSION_STATE_EXITING:
      over_ = true;
      break;
    case XR_SESSION_STATE_LOSS_PENDING:
      throw Lost{};
    default:
      break;
  }
}

void Session::begin() {
  XrSessionBeginInfo info{XR_TYPE_SESSION_BEGIN_INFO};
  info.primaryViewConfigurationType = instance_.view_configuration();
  check(api_.BeginSession(session_, &info), "xrBeginSession");
  running_ = true;
}

bool Session::take_recentred(XrTime display) {
  if (!changes_at_ || display < *changes_at_) return false;
  changes_at_.reset();
  return true;
}

bool Session::take_masks_changed() { return std::exchange(masks_changed_, false); }

void Session::request_exit() {
  if (running_) {
    check(api_.RequestExitSession(session_), "xrRequestExitSession");
  } else {
    over_ = true;
  }
}

FrameTime Session::begin_frame() {
  XrFrameState state{XR_TYPE_FRAME_STATE};
  check(api_.WaitFrame(session_, nullptr, &state), "xrWaitFrame");
  check(api_.BeginFrame(session_, nullptr), "xrBeginFrame");
  return {state.predictedDisplayTime, state.predictedDisplayPeriod, state.shouldRender == XR_TRUE};
}

std::vector<XrView> Session::locate(XrTime display) {
  XrViewLocateInfo info{XR_TYPE_VIEW_LOCATE_INFO};
  info.viewConfigurationType = instance_.view_configuration();
  info.displayTime = display;
  info.space = space_;
  XrViewState state{XR_TYPE_VIEW_STATE};
  XrView empty{};
  empty.type = XR_TYPE_VIEW;
  std::vector<XrView> views =
      all_of("xrLocateViews", empty, [&](std::uint32_t room, std::uint32_t* count, XrView* all) {
        return api_.LocateViews(session_, &info, &state, room, count, all);
      });
  constexpr XrViewStateFlags valid = XR_VIEW_STATE_ORIENTATION_VALID_BIT | XR_VIEW_STATE_POSITION_VALID_BIT;
  if ((state.viewStateFlags & valid) != valid || views.size() < 2) views.clear();
  return views;
}

std::optional<XrPosef> Session::locate(XrSpace other, XrTime display) {
  XrSpaceLocation location{XR_TYPE_SPACE_LOCATION};
  check(api_.LocateSpace(other, space_, display, &location), "xrLocateSpace");
  constexpr XrSpaceLocationFlags valid =
      XR_SPACE_LOCATION_ORIENTATION_VALID_BIT | XR_SPACE_LOCATION_POSITION_VALID_BIT;
  if ((location.locationFlags & valid) != valid) return std::nullopt;
  return location.pose;
}

void Session::end_frame(const FrameTime& frame, const XrCompositionLayerBaseHeader* layer) {
  XrFrameEndInfo info{XR_TYPE_FRAME_END_INFO};
  info.displayTime = frame.display;
  info.environmentBlendMode = blend_mode_;
  info.layerCount = layer != nullptr ? 1 : 0;
  info.layers = layer != nullptr ? &layer : nullptr;
  check(api_.EndFrame(session_, &info), "xrEndFrame");
}

}  // namespace binosplat::xr
