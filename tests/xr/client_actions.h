#pragma once
// What xr/client.cpp does with hands and eyes, and the faults that it can make there.

#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "xr/client_calls.h"

namespace binosplat::xr_test {

class Actions {
 public:
  void make(XrSession session) {
    session_ = session;
    make_set();
    make_actions();
    suggest();
    XrSessionActionSetsAttachInfo info = {XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO, nullptr, 1, &set_};
    if (!has("not_attached")) XR(xrAttachSessionActionSets, session_, &info);
    if (has("attached_twice")) XR(xrAttachSessionActionSets, session_, &info);
    if (has("action_too_late")) make_action("late", XR_ACTION_TYPE_BOOLEAN_INPUT, {hands_[0]});
    if (has("binding_too_late")) suggest();
    for (int hand = 0; hand < 2; ++hand) spaces_[hand] = make_space(aim_, hands_[hand]);
    if (has("space_of_button")) make_space(select_, hands_[0]);
    if (has("gaze")) gaze_space_ = make_space(gaze_, XR_NULL_PATH);
  }

  void destroy() {
    for (const XrSpace space : {spaces_[0], spaces_[1], gaze_space_}) {
      if (space != XR_NULL_HANDLE) XR(xrDestroySpace, space);
    }
    XR(xrDestroyActionSet, set_);
  }

  /// Says what is to be read in a frame.
  void read(int frame, XrSpace base, XrTime time) {
    const XrActiveActionSet active = {set_, XR_NULL_PATH};
    const XrActionsSyncInfo info = {XR_TYPE_ACTIONS_SYNC_INFO, nullptr, 1, &active};
    const XrResult result = XR(xrSyncActions, session_, &info);
    if (result != XR_SUCCESS) return;
    for (int hand = 0; hand < 2; ++hand) {
      std::printf("%d %s:", frame, hand == 0 ? "left" : "right");
      read_hand(hands_[hand]);
      say_place(spaces_[hand], base, time);
    }
    if (has("gaze")) {
      XrActionStatePose pose = {XR_TYPE_ACTION_STATE_POSE};
      get(xrGetActionStatePose, gaze_, XR_NULL_PATH, pose);
      std::printf("%d gaze:", frame);
      say_place(gaze_space_, base, time);
    }
    if (has("wrong_action_type")) {
      XrActionStateVector2f wrong = {XR_TYPE_ACTION_STATE_VECTOR2F};
      get(xrGetActionStateVector2f, select_, hands_[0], wrong);
    }
    if (has("unknown_user")) {
      XrActionStateBoolean state = {XR_TYPE_ACTION_STATE_BOOLEAN};
      get(xrGetActionStateBoolean, select_, path("/user/head"), state);
    }
  }

 private:
  static XrPath path(const std::string& text) {
    XrPath out = XR_NULL_PATH;
    XR(xrStringToPath, instance, text.c_str(), &out);
    return out;
  }

  void make_set() {
    XrActionSetCreateInfo info = {XR_TYPE_ACTION_SET_CREATE_INFO};
    std::strcpy(info.actionSetName, has("bad_action_name") ? "With Capitals" : "all");
    std::strcpy(info.localizedActionSetName, "All");
    XR(xrCreateActionSet, instance, &info, &set_);
    if (has("bad_action_name")) {
      std::strcpy(info.actionSetName, "all");
      XR(xrCreateActionSet, instance, &info, &set_);
    }
    XrActionSet second = XR_NULL_HANDLE;
    if (has("second_action_set")) XR(xrCreateActionSet, instance, &info, &second);
  }

  XrAction make_action(const char* name, XrActionType type, const std::vector<XrPath>& users) const {
    XrActionCreateInfo info = {XR_TYPE_ACTION_CREATE_INFO};
    std::strcpy(info.actionName, name);
    std::strcpy(info.localizedActionName, name);
    info.actionType = type;
    info.countSubactionPaths = static_cast<std::uint32_t>(users.size());
    info.subactionPaths = users.data();
    XrAction action = XR_NULL_HANDLE;
    XR(xrCreateAction, set_, &info, &action);
    return action;
  }

  void make_actions() {
    hands_[0] = path("/user/hand/left");
    hands_[1] = path("/user/hand/right");
    const std::vector<XrPath> both = {hands_[0], hands_[1]};
    select_ = make_action("select", XR_ACTION_TYPE_BOOLEAN_INPUT, both);
    stick_ = make_action("stick", XR_ACTION_TYPE_VECTOR2F_INPUT, both);
    aim_ = make_action("aim", XR_ACTION_TYPE_POSE_INPUT, both);
    if (has("gaze")) gaze_ = make_action("gaze", XR_ACTION_TYPE_POSE_INPUT, {});
    if (has("second_action")) make_action("aim", XR_ACTION_TYPE_POSE_INPUT, both);
    if (has("unknown_hand")) make_action("foot", XR_ACTION_TYPE_POSE_INPUT, {path("/user/foot/left")});
  }

  void suggest_for(const char* profile, const std::vector<std::pair<XrAction, std::string>>& below) const {
    std::vector<XrActionSuggestedBinding> bindings;
    for (const auto& [action, component] : below) {
      for (const char* hand : {"/user/hand/left", "/user/hand/right"}) {
        bindings.push_back({action, path(action == gaze_ ? component : hand + component)});
      }
    }
    const XrInteractionProfileSuggestedBinding info = {
        XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING, nullptr, path(profile),
        static_cast<std::uint32_t>(bindings.size()), bindings.data()};
    XR(xrSuggestInteractionProfileBindings, instance, &info);
  }

  void suggest() const {
    suggest_for("/interaction_profiles/khr/simple_controller",
                {{select_, "/input/select/click"}, {aim_, "/input/aim/pose"}});
    suggest_for(
        "/interaction_profiles/oculus/touch_controller",
        {{select_, "/input/thumbstick/click"}, {stick_, "/input/thumbstick"}, {aim_, "/input/aim/pose"}});
    suggest_for("/interaction_profiles/valve/index_controller",
                {{select_, "/input/a/click"}, {aim_, "/input/grip/pose"}});
    suggest_for("/interaction_profiles/microsoft/motion_controller", {{stick_, "/input/trackpad"}});
    if (has("gaze")) {
      suggest_for("/interaction_profiles/ext/eye_gaze_interaction",
                  {{gaze_, "/user/eyes_ext/input/gaze_ext/pose"}});
    }
    if (has("bad_binding")) {
      suggest_for("/interaction_profiles/khr/simple_controller", {{select_, "/input/trigger/value"}});
    }
    if (has("bad_profile"))
      suggest_for("/interaction_profiles/none/at_all", {{select_, "/input/select/click"}});
    if (has("binding_of_another_type")) {
      suggest_for("/interaction_profiles/khr/simple_controller", {{select_, "/input/aim/pose"}});
    }
  }

  XrSpace make_space(XrAction action, XrPath user) const {
    const XrActionSpaceCreateInfo info = {
        XR_TYPE_ACTION_SPACE_CREATE_INFO, nullptr, action, user, {{0, 0, 0, 1}, {0, 0, 0}}};
    XrSpace space = XR_NULL_HANDLE;
    XR(xrCreateActionSpace, session_, &info, &space);
    return space;
  }

  template <typename State>
  void get(XrResult (*function)(XrSession, const XrActionStateGetInfo*, State*), XrAction action, XrPath user,
           State& state) const {
    const XrActionStateGetInfo info = {XR_TYPE_ACTION_STATE_GET_INFO, nullptr, action, user};
    say("get", function(session_, &info, &state));
  }

  void read_hand(XrPath hand) const {
    XrActionStateBoolean select = {XR_TYPE_ACTION_STATE_BOOLEAN};
    get(xrGetActionStateBoolean, select_, hand, select);
    XrActionStateVector2f stick = {XR_TYPE_ACTION_STATE_VECTOR2F};
    get(xrGetActionStateVector2f, stick_, hand, stick);
    if (select.isActive == XR_TRUE)
      std::printf(" select %u%s", select.currentState, select.changedSinceLastSync ? "!" : "");
    if (stick.isActive == XR_TRUE) std::printf(" stick %g,%g", stick.currentState.x, stick.currentState.y);
  }

  static void say_place(XrSpace space, XrSpace base, XrTime time) {
    XrSpaceLocation location = {XR_TYPE_SPACE_LOCATION};
    XR(xrLocateSpace, space, base, time, &location);
    const XrVector3f& p = location.pose.position;
    if (location.locationFlags != 0) {
      std::printf(" at %g,%g,%g\n", p.x, p.y, p.z);
    } else {
      std::printf(" nowhere\n");
    }
  }

  XrSession session_ = XR_NULL_HANDLE;
  XrActionSet set_ = XR_NULL_HANDLE;
  XrPath hands_[2] = {};
  XrAction select_ = XR_NULL_HANDLE, stick_ = XR_NULL_HANDLE, aim_ = XR_NULL_HANDLE, gaze_ = XR_NULL_HANDLE;
  XrSpace spaces_[2] = {}, gaze_space_ = XR_NULL_HANDLE;
};

}  // namespace binosplat::xr_test
