// What the controllers that the runtime plays have.

#include <map>

#include "xr/runtime/api.h"

namespace binosplat::xr_test {
namespace {

using Paths = std::set<std::string>;

// As the specification lists them, below /user/hand/left and right; "left:" and "right:": of one hand only.
const std::map<std::string, Paths>& profiles() {
  static const Paths all_have = {"input/grip/pose", "input/aim/pose"};
  static const std::map<std::string, Paths> own = {
      {"khr/simple_controller", {"input/select/click", "input/menu/click"}},
      {"oculus/touch_controller",
       {"left:input/x/click", "left:input/x/touch", "left:input/y/click", "left:input/y/touch",
        "left:input/menu/click", "right:input/a/click", "right:input/a/touch", "right:input/b/click",
        "right:input/b/touch", "right:input/system/click", "input/squeeze/value", "input/trigger/value",
        "input/trigger/touch", "input/thumbstick", "input/thumbstick/x", "input/thumbstick/y",
        "input/thumbstick/click", "input/thumbstick/touch", "input/thumbrest/touch"}},
      {"valve/index_controller",
       {"input/system/click",  "input/system/touch",  "input/a/click",          "input/a/touch",
        "input/b/click",       "input/b/touch",       "input/squeeze/value",    "input/squeeze/force",
        "input/trigger/click", "input/trigger/value", "input/trigger/touch",    "input/thumbstick",
        "input/thumbstick/x",  "input/thumbstick/y",  "input/thumbstick/click", "input/thumbstick/touch",
        "input/trackpad",      "input/trackpad/x",    "input/trackpad/y",       "input/trackpad/force",
        "input/trackpad/touch"}},
      {"microsoft/motion_controller",
       {"input/menu/click", "input/squeeze/click", "input/trigger/value", "input/thumbstick",
        "input/thumbstick/x", "input/thumbstick/y", "input/thumbstick/click", "input/trackpad",
        "input/trackpad/x", "input/trackpad/y", "input/trackpad/click", "input/trackpad/touch"}},
      {"htc/vive_controller",
       {"input/system/click", "input/squeeze/click", "input/menu/click", "input/trigger/click",
        "input/trigger/value", "input/trackpad", "input/trackpad/x", "input/trackpad/y",
        "input/trackpad/click", "input/trackpad/touch"}}};
  static const std::map<std::string, Paths> out = [] {
    std::map<std::string, Paths> full;
    for (const auto& [name, below] : own) {
      Paths& paths = full["/interaction_profiles/" + name];
      Paths both = below;
      both.insert(all_have.begin(), all_have.end());
      for (const std::string& path : both) {
        const std::size_t colon = path.find(':');
        for (const std::string hand : {"left", "right"}) {
          if (colon == std::string::npos || path.substr(0, colon) == hand) {
            paths.insert("/user/hand/" + hand + "/" +
                         path.substr(colon == std::string::npos ? 0 : colon + 1));
          }
        }
      }
    }
    full["/interaction_profiles/ext/eye_gaze_interaction"] = {"/user/eyes_ext/input/gaze_ext/pose"};
    return full;
  }();
  return out;
}

}  // namespace

bool is_profile(const std::string& profile) {
  const bool gaze = profile == "/interaction_profiles/ext/eye_gaze_interaction";
  return profiles().count(profile) != 0 &&
         (!gaze || runtime().instance()->extensions.count(XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME) != 0);
}

std::string component_of(const std::string& profile, const std::string& path) {
  const Paths& paths = profiles().at(profile);
  for (const char* end : {"", "/value", "/click", "/pose"}) {
    if (paths.count(path + end) != 0) return path + end;
  }
  return "";
}

}  // namespace binosplat::xr_test
