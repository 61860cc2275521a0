// What actions read: the script's values, as xrSyncActions saw them last.

#include <algorithm>
#include <cmath>

#include "xr/runtime/api.h"

namespace binosplat::xr_test {
namespace {

constexpr const char* gaze_profile = "/interaction_profiles/ext/eye_gaze_interaction";
constexpr const char* gaze_user = "/user/eyes_ext";

std::string user_of(const std::string& component) {
  for (const char* user : {"/user/hand/left", "/user/hand/right", gaze_user}) {
    if (component.rfind(user, 0) == 0) return user;
  }
  return "";
}

/// The interaction profile of a user path now; empty: nobody is there, or nothing was bound.
std::string profile_of(const std::string& user) {
  const Runtime& r = runtime();
  std::string profile;
  if (user == gaze_user) {
    if (r.script.gaze) profile = gaze_profile;
  } else if (r.script.hands.count(user.substr(user.rfind('/') + 1)) != 0) {
    profile = r.script.profile;
  }
  return r.suggested.count(profile) != 0 ? profile : "";
}

double number(const Json& value) {
  if (value.is_boolean()) return value.get<bool>() ? 1.0 : 0.0;
  return value.is_number() ? value.get<double>() : 0.0;
}

std::array<double, 2> vector(const Json& value) {
  return value.is_array() ? value.get<std::array<double, 2>>() : std::array<double, 2>{0, 0};
}

/// The one of two values that an action of several sources has.
Json stronger(XrActionType type, const Json& a, const Json& b) {
  if (type == XR_ACTION_TYPE_VECTOR2F_INPUT) {
    const auto va = vector(a), vb = vector(b);
    return std::hypot(va[0], va[1]) >= std::hypot(vb[0], vb[1]) ? a : b;
  }
  if (type == XR_ACTION_TYPE_POSE_INPUT) return a.is_null() ? b : a;
  return std::abs(number(a)) >= std::abs(number(b)) ? a : b;
}

std::vector<std::string> bound(const Action& action, const std::string& user) {
  std::vector<std::string> out;
  const auto found = action.bindings.find(profile_of(user));
  if (found == action.bindings.end()) return out;
  for (const std::string& component : found->second) {
    if (user_of(component) == user) out.push_back(component);
  }
  return out;
}

void sync(Action& action, bool active_set) {
  const Runtime& r = runtime();
  for (const std::string user : {"/user/hand/left", "/user/hand/right", gaze_user}) {
    ActionState& state = action.states[user];
    const Json before = state.value;
    state.value = nullptr;
    const auto components = bound(action, user);
    state.active = active_set && !components.empty();
    for (const std::string& component : components) {
      const auto input = r.input.find(component);
      if (state.active && input != r.input.end())
        state.value = stronger(action.type, state.value, input->second);
    }
    state.changed = state.value != before;
    if (state.changed) state.time = r.time_of(runtime().frame());
  }
}

const Action& action_of(XrSession session, const XrActionStateGetInfo* info, XrActionType type) {
  Runtime& r = runtime();
  r.get<Session>(session);
  checked(info, XR_TYPE_ACTION_STATE_GET_INFO);
  const auto& action = r.get<Action>(info->action);
  require(dynamic_cast<ActionSet&>(*r.objects.at(action.parent)).attached, XR_ERROR_ACTIONSET_NOT_ATTACHED,
          "the set of action " + action.name + " is not attached");
  require(action.type == type, XR_ERROR_ACTION_TYPE_MISMATCH,
          "action " + action.name + " is of another type");
  return action;
}

/// An action's state for a user path, or for all.
ActionState state_of(const Action& action, XrPath user) {
  if (user != XR_NULL_PATH) {
    const std::string& name = text_of(user);
    require(action.users.count(name) != 0, XR_ERROR_PATH_UNSUPPORTED,
            "action " + action.name + " was not made with " + name);
    const auto found = action.states.find(name);
    return found == action.states.end() ? ActionState() : found->second;
  }
  ActionState out;
  for (const auto& [name, state] : action.states) {
    if (!state.active) continue;
    out.value = out.active ? stronger(action.type, out.value, state.value) : state.value;
    out.active = true;
    out.changed = out.changed || state.changed;
    out.time = std::max(out.time, state.time);
  }
  return out;
}

}  // namespace

std::optional<Pose> pose_of_action(const Space& space, XrTime time) {
  Runtime& r = runtime();
  const auto found = r.objects.find(space.action);
  if (found == r.objects.end()) return std::nullopt;
  const auto& action = dynamic_cast<const Action&>(*found->second);
  const auto gaze = action.states.find(gaze_user);
  const bool of_eyes = space.subaction == XR_NULL_PATH || text_of(space.subaction) == gaze_user;
  if (of_eyes && gaze != action.states.end() && gaze->second.active && r.script.gaze) {
    return head_at(time) * *r.script.gaze * space.offset;
  }
  const ActionState state = state_of(action, space.subaction);
  if (!state.active || !state.value.is_object()) return std::nullopt;
  return pose_from(state.value) * space.offset;
}

namespace api {

XrResult sync_actions(XrSession handle, const XrActionsSyncInfo* info) {
  Runtime& r = runtime();
  auto& session = r.get<Session>(handle);
  checked(info, XR_TYPE_ACTIONS_SYNC_INFO);
  std::set<std::uint64_t> active;
  for (std::uint32_t k = 0; k < info->countActiveActionSets; ++k) {
    const auto& set = r.get<ActionSet>(info->activeActionSets[k].actionSet);
    require(set.attached, XR_ERROR_ACTIONSET_NOT_ATTACHED, "set " + set.name + " is not attached");
    active.insert(set.id);
  }
  const bool focused = session.state == XR_SESSION_STATE_FOCUSED;
  for (const auto& [id, object] : r.objects) {
    if (auto* action = dynamic_cast<Action*>(object.get())) {
      sync(*action, focused && active.count(action->parent) != 0);
    }
  }
  return focused ? XR_SUCCESS : XR_SESSION_NOT_FOCUSED;
}

// What the states of all types but poses have.
template <typename State>
void tell_change(const ActionState& state, State& out) {
  out.changedSinceLastSync = state.changed ? XR_TRUE : XR_FALSE;
  out.lastChangeTime = state.time;
  out.isActive = state.active ? XR_TRUE : XR_FALSE;
}

XrResult get_action_state_boolean(XrSession handle, const XrActionStateGetInfo* info,
                                  XrActionStateBoolean* out) {
  const Action& action = action_of(handle, info, XR_ACTION_TYPE_BOOLEAN_INPUT);
  checked(out, XR_TYPE_ACTION_STATE_BOOLEAN);
  const ActionState state = state_of(action, info->subactionPath);
  out->currentState = number(state.value) > 0.5 ? XR_TRUE : XR_FALSE;
  tell_change(state, *out);
  return XR_SUCCESS;
}

XrResult get_action_state_vector2f(XrSession handle, const XrActionStateGetInfo* info,
                                   XrActionStateVector2f* out) {
  const Action& action = action_of(handle, info, XR_ACTION_TYPE_VECTOR2F_INPUT);
  checked(out, XR_TYPE_ACTION_STATE_VECTOR2F);
  const ActionState state = state_of(action, info->subactionPath);
  const auto v = vector(state.value);
  out->currentState = {static_cast<float>(v[0]), static_cast<float>(v[1])};
  tell_change(state, *out);
  return XR_SUCCESS;
}

XrResult get_action_state_pose(XrSession handle, const XrActionStateGetInfo* info, XrActionStatePose* out) {
  const Action& action = action_of(handle, info, XR_ACTION_TYPE_POSE_INPUT);
  checked(out, XR_TYPE_ACTION_STATE_POSE);
  out->isActive = state_of(action, info->subactionPath).active ? XR_TRUE : XR_FALSE;
  return XR_SUCCESS;
}

}  // namespace api
}  // namespace binosplat::xr_test
