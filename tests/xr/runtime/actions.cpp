// Actions: how they are made and bound.

#include <algorithm>
#include <cstring>

#include "xr/runtime/api.h"

namespace binosplat::xr_test::api {
namespace {

/// A name that is a path of one level.
void check_name(const char* name, const char* localized) {
  const std::string text = name;
  require(!text.empty(), XR_ERROR_NAME_INVALID, "no name");
  require(text.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-_.") == std::string::npos,
          XR_ERROR_PATH_FORMAT_INVALID, "'" + text + "' is no name: lower case, digits, - _ . are expected");
  require(*localized != '\0', XR_ERROR_LOCALIZED_NAME_INVALID, text + " has no localized name");
}

/// No sibling of the same names.
template <typename T>
void check_unique(std::uint64_t parent, const std::string& name, const std::string& localized) {
  for (const auto& [id, object] : runtime().objects) {
    const auto* other = dynamic_cast<const T*>(object.get());
    if (other == nullptr || other->parent != parent) continue;
    require(other->name != name, XR_ERROR_NAME_DUPLICATED, "a second " + name);
    require(other->localized != localized, XR_ERROR_LOCALIZED_NAME_DUPLICATED,
            "a second '" + localized + "'");
  }
}

/// Whether an action of a type can be read from a component.
bool fits(XrActionType type, const std::string& component) {
  const auto ends = [&](const std::string& end) {
    return component.size() >= end.size() && component.substr(component.size() - end.size()) == end;
  };
  const bool pose = ends("/pose"), vector = ends("/thumbstick") || ends("/trackpad");
  switch (type) {
    case XR_ACTION_TYPE_POSE_INPUT:
      return pose;
    case XR_ACTION_TYPE_VECTOR2F_INPUT:
      return vector;
    default:
      return !pose && !vector;
  }
}

}  // namespace

XrResult create_action_set(XrInstance handle, const XrActionSetCreateInfo* info, XrActionSet* out) {
  const auto& instance = runtime().get<Instance>(handle);
  checked(info, XR_TYPE_ACTION_SET_CREATE_INFO);
  check_name(info->actionSetName, info->localizedActionSetName);
  check_unique<ActionSet>(instance.id, info->actionSetName, info->localizedActionSetName);
  auto& set = runtime().add<ActionSet>(instance.id);
  set.name = info->actionSetName;
  set.localized = info->localizedActionSetName;
  *out = handle_of<XrActionSet>(set);
  return XR_SUCCESS;
}

XrResult destroy_action_set(XrActionSet handle) {
  runtime().destroy(runtime().get<ActionSet>(handle, true));
  return XR_SUCCESS;
}

XrResult create_action(XrActionSet handle, const XrActionCreateInfo* info, XrAction* out) {
  const auto& set = runtime().get<ActionSet>(handle);
  checked(info, XR_TYPE_ACTION_CREATE_INFO);
  require(!set.attached, XR_ERROR_ACTIONSETS_ALREADY_ATTACHED, "set " + set.name + " is attached already");
  check_name(info->actionName, info->localizedActionName);
  check_unique<Action>(set.id, info->actionName, info->localizedActionName);
  std::set<std::string> users;
  for (std::uint32_t k = 0; k < info->countSubactionPaths; ++k) {
    const std::string& user = text_of(info->subactionPaths[k]);
    static const std::set<std::string> known = {"/user/hand/left", "/user/hand/right", "/user/head",
                                                "/user/gamepad", "/user/eyes_ext"};
    require(known.count(user) != 0, XR_ERROR_PATH_UNSUPPORTED, user + " is nobody's path");
    require(users.insert(user).second, XR_ERROR_PATH_UNSUPPORTED, user + " twice");
  }
  auto& action = runtime().add<Action>(set.id);
  action.name = info->actionName;
  action.localized = info->localizedActionName;
  action.type = info->actionType;
  action.users = users;
  *out = handle_of<XrAction>(action);
  return XR_SUCCESS;
}

XrResult destroy_action(XrAction handle) {
  runtime().destroy(runtime().get<Action>(handle, true));
  return XR_SUCCESS;
}

XrResult suggest_interaction_profile_bindings(XrInstance handle,
                                              const XrInteractionProfileSuggestedBinding* info) {
  Runtime& r = runtime();
  r.get<Instance>(handle);
  checked(info, XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING);
  const std::string& profile = text_of(info->interactionProfile);
  require(is_profile(profile), XR_ERROR_PATH_UNSUPPORTED, profile + " is no profile that is known");
  require(info->countSuggestedBindings > 0, XR_ERROR_VALIDATION_FAILURE, "no bindings");
  std::vector<std::pair<Action*, std::string>> found;
  for (std::uint32_t k = 0; k < info->countSuggestedBindings; ++k) {
    const XrActionSuggestedBinding& binding = info->suggestedBindings[k];
    auto& action = r.get<Action>(binding.action);
    const bool attached = dynamic_cast<ActionSet&>(*r.objects.at(action.parent)).attached;
    require(!attached, XR_ERROR_ACTIONSETS_ALREADY_ATTACHED,
            "action " + action.name + " is attached already");
    const std::string component = component_of(profile, text_of(binding.binding));
    require(!component.empty(), XR_ERROR_PATH_UNSUPPORTED, profile + " has no " + text_of(binding.binding));
    require(fits(action.type, component), XR_ERROR_PATH_UNSUPPORTED,
            "action " + action.name + " is of another type than " + component);
    found.emplace_back(&action, component);
  }
  for (const auto& [id, object] : r.objects) {
    if (auto* action = dynamic_cast<Action*>(object.get())) action->bindings.erase(profile);
  }
  for (const auto& [action, component] : found) action->bindings[profile].push_back(component);
  r.suggested.insert(profile);
  r.log({{"what", "bindings"}, {"profile", profile}, {"count", found.size()}});
  return XR_SUCCESS;
}

XrResult attach_session_action_sets(XrSession handle, const XrSessionActionSetsAttachInfo* info) {
  Runtime& r = runtime();
  auto& session = r.get<Session>(handle);
  checked(info, XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO);
  require(!session.attached, XR_ERROR_ACTIONSETS_ALREADY_ATTACHED, "action sets are attached already");
  require(info->countActionSets > 0, XR_ERROR_VALIDATION_FAILURE, "no action sets");
  for (std::uint32_t k = 0; k < info->countActionSets; ++k) {
    r.get<ActionSet>(info->actionSets[k]).attached = true;
  }
  session.attached = true;
  return XR_SUCCESS;
}

}  // namespace binosplat::xr_test::api
