#include "xr/hands.h"

#include "base/log.h"

namespace binosplat::xr {

namespace {

// Paths of a controller's inputs, below its hand's path. Empty: the controller lacks the input.
struct Controller {
  const char* profile;
  const char* stick;
  const char* grab;
  const char* left_menu;  // if only the left hand's controller has a menu button
  const char* menu;       // if both controllers have a menu button
};
constexpr Controller controllers[] = {
    {"khr/simple_controller", "", "/input/select/click", "", "/input/menu/click"},
    {"oculus/touch_controller", "/input/thumbstick", "/input/squeeze/value", "/input/menu/click", ""},
    {"valve/index_controller", "/input/thumbstick", "/input/squeeze/value", "/input/b/click", ""},
    {"microsoft/motion_controller", "/input/thumbstick", "/input/squeeze/click", "", "/input/menu/click"},
    {"htc/vive_controller", "/input/trackpad", "/input/squeeze/click", "", "/input/menu/click"},
};

}  // namespace

Hands::Hands(const Session& session) : session_(session) {
  const Instance& instance = session.instance();
  paths_ = {instance.path("/user/hand/left"), instance.path("/user/hand/right")};
  const XrActionSetCreateInfo info{XR_TYPE_ACTION_SET_CREATE_INFO, nullptr, "walk", "Walk", 0};
  set_ = XR_OWNED(ActionSet, CreateActionSet, instance.handle.get(), &info);
  pose_ = make_action("hand", "Hand", XR_ACTION_TYPE_POSE_INPUT);
  stick_ = make_action("stick", "Walk (left), turn and rise (right)", XR_ACTION_TYPE_VECTOR2F_INPUT);
  grab_ = make_action("grab", "Hold the world", XR_ACTION_TYPE_BOOLEAN_INPUT);
  menu_ = make_action("reset", "Back to the start", XR_ACTION_TYPE_BOOLEAN_INPUT);
  if (instance.has(XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME))
    gaze_ = make_action("gaze", "Gaze", XR_ACTION_TYPE_POSE_INPUT, false);
  suggest_bindings();
  const XrActionSet set = set_.get();
  const XrSessionActionSetsAttachInfo attach{XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO, nullptr, 1, &set};
  XR(AttachSessionActionSets, session.handle(), &attach);
  for (std::size_t k = 0; k < 2; ++k) spaces_[k] = make_space(pose_, paths_[k]);
  if (gaze_) gaze_space_ = make_space(gaze_, XR_NULL_PATH);
}

Owned<XrAction> Hands::make_action(const char* name, const char* shown, XrActionType type, bool of_hands) {
  XrActionCreateInfo info{XR_TYPE_ACTION_CREATE_INFO};
  std::strcpy(info.actionName, name);
  std::strcpy(info.localizedActionName, shown);
  info.actionType = type;
  info.countSubactionPaths = of_hands ? 2 : 0;
  info.subactionPaths = of_hands ? paths_.data() : nullptr;
  return XR_OWNED(Action, CreateAction, set_.get(), &info);
}

Owned<XrSpace> Hands::make_space(const Owned<XrAction>& action, XrPath hand) const {
  const XrActionSpaceCreateInfo info{XR_TYPE_ACTION_SPACE_CREATE_INFO, nullptr, action.get(), hand, no_move};
  return XR_OWNED(Space, CreateActionSpace, session_.handle(), &info);
}

void Hands::suggest_bindings() {
  const Instance& instance = session_.instance();
  const auto suggest = [&](const std::string& profile,
                           const std::vector<XrActionSuggestedBinding>& bindings) {
    const XrInteractionProfileSuggestedBinding info{XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING, nullptr,
                                                    instance.path("/interaction_profiles/" + profile),
                                                    static_cast<std::uint32_t>(bindings.size()),
                                                    bindings.data()};
    const XrResult result = XR_CALL(SuggestInteractionProfileBindings, instance.handle.get(), &info);
    // Other profiles may still work.
    if (XR_FAILED(result))
      log_warning("{} does not know {} ({})", instance.runtime, profile, name_of(result));
  };
  for (const Controller& c : controllers) {
    std::vector<XrActionSuggestedBinding> bindings;
    for (const std::string hand : {"/user/hand/left", "/user/hand/right"}) {
      const auto bind = [&](const Owned<XrAction>& action, const char* input) {
        if (*input != '\0') bindings.push_back({action.get(), instance.path(hand + input)});
      };
      bind(pose_, "/input/grip/pose");
      bind(stick_, c.stick);
      bind(grab_, c.grab);
      bind(menu_, c.menu);
      if (hand == "/user/hand/left") bind(menu_, c.left_menu);
    }
    suggest(c.profile, bindings);
  }
  if (gaze_)
    suggest("ext/eye_gaze_interaction", {{gaze_.get(), instance.path("/user/eyes_ext/input/gaze_ext/pose")}});
}

Input Hands::read(XrTime display) {
  Input input;
  const XrActiveActionSet active{set_.get(), XR_NULL_PATH};
  const XrActionsSyncInfo sync{XR_TYPE_ACTIONS_SYNC_INFO, nullptr, 1, &active};
  if (XR(SyncActions, session_.handle(), &sync) == XR_SESSION_NOT_FOCUSED) return input;
  for (std::size_t k = 0; k < 2; ++k) {
    const auto wanted = [&](const Owned<XrAction>& action) {
      return XrActionStateGetInfo{XR_TYPE_ACTION_STATE_GET_INFO, nullptr, action.get(), paths_[k]};
    };
    const auto of_stick = wanted(stick_), of_grab = wanted(grab_), of_menu = wanted(menu_);
    XrActionStateVector2f stick{XR_TYPE_ACTION_STATE_VECTOR2F};
    XrActionStateBoolean grab{XR_TYPE_ACTION_STATE_BOOLEAN}, menu{XR_TYPE_ACTION_STATE_BOOLEAN};
    XR(GetActionStateVector2f, session_.handle(), &of_stick, &stick);
    XR(GetActionStateBoolean, session_.handle(), &of_grab, &grab);
    XR(GetActionStateBoolean, session_.handle(), &of_menu, &menu);
    Hand& hand = input.hands[k];
    if (stick.isActive) hand.stick = {stick.currentState.x, stick.currentState.y};
    hand.grabs = grab.isActive && grab.currentState;
    input.resets = input.resets || (menu.isActive && menu.changedSinceLastSync && menu.currentState);
    if (const auto at = session_.locate(spaces_[k].get(), display))
      hand.position = glm::dvec3(at->position.x, at->position.y, at->position.z);
  }
  if (gaze_) input.gaze = session_.locate(gaze_space_.get(), display);
  return input;
}

}  // namespace binosplat::xr
