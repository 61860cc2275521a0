#include "xr/hands.h"

#include <cstring>
#include <string>

#include "base/log.h"

namespace binosplat::xr {

namespace {

// Where a kind of controller has what the actions need, below its hand; empty: nowhere.
struct Controller {
  const char* profile;
  const char* stick;
  const char* grab;
  const char* left_menu;  // where only one hand has it,
  const char* menu;       // and where both have
};
constexpr Controller controllers[] = {
    {"khr/simple_controller", "", "/input/select/click", "", "/input/menu/click"},
    {"oculus/touch_controller", "/input/thumbstick", "/input/squeeze/value", "/input/menu/click", ""},
    {"valve/index_controller", "/input/thumbstick", "/input/squeeze/value", "/input/b/click", ""},
    {"microsoft/motion_controller", "/input/thumbstick", "/input/squeeze/click", "", "/input/menu/click"},
    {"htc/vive_controller", "/input/trackpad", "/input/squeeze/click", "", "/input/menu/click"},
};

}  // namespace

Hands::Hands(Session& session) : session_(session), api_(session.instance().api()) {
  const Instance& instance = session.instance();
  paths_ = {instance.path("/user/hand/left"), instance.path("/user/hand/right")};
  XrActionSetCreateInfo info{XR_TYPE_ACTION_SET_CREATE_INFO};
  std::strcpy(info.actionSetName, "walk");
  std::strcpy(info.localizedActionSetName, "Walk");
  check(api_.CreateActionSet(instance.handle(), &info, &set_), "xrCreateActionSet");
  try {
    make_actions();
  } catch (...) {
    release();
    throw;
  }
}

void Hands::make_actions() {
  const Instance& instance = session_.instance();
  pose_ = make_action("hand", "Hand", XR_ACTION_TYPE_POSE_INPUT);
  stick_ = make_action("stick", "Walk (left), turn and rise (right)", XR_ACTION_TYPE_VECTOR2F_INPUT);
  grab_ = make_action("grab", "Hold the world", XR_ACTION_TYPE_BOOLEAN_INPUT);
  menu_ = make_action("reset", "Back to the start", XR_ACTION_TYPE_BOOLEAN_INPUT);
  if (instance.has(XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME))
    gaze_ = make_action("gaze", "Gaze", XR_ACTION_TYPE_POSE_INPUT);
  suggest_bindings();
  XrSessionActionSetsAttachInfo attach{XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO};
  attach.countActionSets = 1;
  attach.actionSets = &set_;
  check(api_.AttachSessionActionSets(session_.handle(), &attach), "xrAttachSessionActionSets");
  const auto space_of = [&](XrAction action, XrPath hand) {
    XrActionSpaceCreateInfo wanted{XR_TYPE_ACTION_SPACE_CREATE_INFO};
    wanted.action = action;
    wanted.subactionPath = hand;
    wanted.poseInActionSpace = no_move;
    XrSpace space = XR_NULL_HANDLE;
    check(api_.CreateActionSpace(session_.handle(), &wanted, &space), "xrCreateActionSpace");
    return space;
  };
  for (std::size_t k = 0; k < 2; ++k) spaces_[k] = space_of(pose_, paths_[k]);
  if (gaze_ != XR_NULL_HANDLE) gaze_space_ = space_of(gaze_, XR_NULL_PATH);
}

Hands::~Hands() { release(); }

void Hands::release() {
  if (gaze_space_ != XR_NULL_HANDLE) api_.DestroySpace(gaze_space_);
  for (const XrSpace space : spaces_) {
    if (space != XR_NULL_HANDLE) api_.DestroySpace(space);
  }
  for (const XrAction action : {pose_, stick_, grab_, menu_, gaze_}) {
    if (action != XR_NULL_HANDLE) api_.DestroyAction(action);
  }
  api_.DestroyActionSet(set_);
}

XrAction Hands::make_action(const char* name, const char* shown, XrActionType type) {
  XrActionCreateInfo info{XR_TYPE_ACTION_CREATE_INFO};
  std::strcpy(info.actionName, name);
  std::strcpy(info.localizedActionName, shown);
  info.actionType = type;
  if (std::strcmp(name, "gaze") != 0) {
    info.countSubactionPaths = static_cast<std::uint32_t>(paths_.size());
    info.subactionPaths = paths_.data();
  }
  XrAction action = XR_NULL_HANDLE;
  check(api_.CreateAction(set_, &info, &action), "xrCreateAction");
  return action;
}

void Hands::suggest_bindings() {
  const Instance& instance = session_.instance();
  const auto suggest = [&](const std::string& profile,
                           const std::vector<XrActionSuggestedBinding>& bindings) {
    XrInteractionProfileSuggestedBinding info{XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING};
    info.interactionProfile = instance.path("/interaction_profiles/" + profile);
    info.countSuggestedBindings = static_cast<std::uint32_t>(bindings.size());
    info.suggestedBindings = bindings.data();
    const XrResult result = api_.SuggestInteractionProfileBindings(instance.handle(), &info);
    // Others may still do.
    if (XR_FAILED(result))
      log_warning("{} does not know {} ({})", instance.runtime(), profile, name_of(result));
  };
  for (const Controller& c : controllers) {
    std::vector<XrActionSuggestedBinding> bindings;
    for (const std::string hand : {"/user/hand/left", "/user/hand/right"}) {
      const auto bind = [&](XrAction action, const char* input) {
        if (*input != '\0') bindings.push_back({action, instance.path(hand + input)});
      };
      bind(pose_, "/input/grip/pose");
      bind(stick_, c.stick);
      bind(grab_, c.grab);
      bind(menu_, c.menu);
      if (hand.ends_with("left")) bind(menu_, c.left_menu);
    }
    suggest(c.profile, bindings);
  }
  if (gaze_ != XR_NULL_HANDLE)
    suggest("ext/eye_gaze_interaction", {{gaze_, instance.path("/user/eyes_ext/input/gaze_ext/pose")}});
}

InputActions Hands::read(XrTime display) {
  InputActions actions;
  const XrActiveActionSet active{set_, XR_NULL_PATH};
  XrActionsSyncInfo sync{XR_TYPE_ACTIONS_SYNC_INFO};
  sync.countActiveActionSets = 1;
  sync.activeActionSets = &active;
  const XrResult synced = api_.SyncActions(session_.handle(), &sync);
  check(synced, "xrSyncActions");
  if (synced == XR_SESSION_NOT_FOCUSED) return actions;
  for (std::size_t k = 0; k < 2; ++k) {
    XrActionStateGetInfo wanted{XR_TYPE_ACTION_STATE_GET_INFO};
    wanted.subactionPath = paths_[k];
    const auto state_of = [&](XrAction action, auto state, auto get, const char* call) {
      wanted.action = action;
      check(get(session_.handle(), &wanted, &state), call);
      return state;
    };
    const auto pose = state_of(pose_, XrActionStatePose{XR_TYPE_ACTION_STATE_POSE}, api_.GetActionStatePose,
                               "xrGetActionStatePose");
    const auto stick = state_of(stick_, XrActionStateVector2f{XR_TYPE_ACTION_STATE_VECTOR2F},
                                api_.GetActionStateVector2f, "xrGetActionStateVector2f");
    const auto grab = state_of(grab_, XrActionStateBoolean{XR_TYPE_ACTION_STATE_BOOLEAN},
                               api_.GetActionStateBoolean, "xrGetActionStateBoolean");
    const auto menu = state_of(menu_, XrActionStateBoolean{XR_TYPE_ACTION_STATE_BOOLEAN},
                               api_.GetActionStateBoolean, "xrGetActionStateBoolean");
    Hand& hand = actions.hands[k];
    if (stick.isActive) hand.stick = {stick.currentState.x, stick.currentState.y};
    hand.grabs = grab.isActive && grab.currentState;
    actions.resets = actions.resets || (menu.isActive && menu.changedSinceLastSync && menu.currentState);
    if (!pose.isActive) continue;
    if (const auto at = session_.locate(spaces_[k], display))
      hand.position = glm::dvec3(at->position.x, at->position.y, at->position.z);
  }
  return actions;
}

std::optional<XrPosef> Hands::gaze(XrTime display) {
  if (gaze_space_ == XR_NULL_HANDLE || !session_.focused()) return std::nullopt;
  XrActionStateGetInfo wanted{XR_TYPE_ACTION_STATE_GET_INFO};
  wanted.action = gaze_;
  XrActionStatePose state{XR_TYPE_ACTION_STATE_POSE};
  check(api_.GetActionStatePose(session_.handle(), &wanted, &state), "xrGetActionStatePose");
  return state.isActive ? session_.locate(gaze_space_, display) : std::nullopt;
}

}  // namespace binosplat::xr
