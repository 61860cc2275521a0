#pragma once
// Controllers and eyes as OpenXR's actions have them. Without any, all is at rest.

#include <array>
#include <optional>

#include "xr/session.h"
#include "xr/walk.h"

namespace binosplat::xr {

/// What the hands do at a moment.
struct InputActions {
  std::array<Hand, 2> hands;
  bool resets = false;  // the menu button was pushed
};

class Hands {
 public:
  explicit Hands(Session& session);
  ~Hands();
  Hands(const Hands&) = delete;
  Hands& operator=(const Hands&) = delete;

  /// Where hands will be at that time, and what they do now.
  InputActions read(XrTime display);
  /// Where the eyes look from and to, in the session's space; nothing where no eye tracker tells.
  std::optional<XrPosef> gaze(XrTime display);

 private:
  void make_actions();
  void suggest_bindings();
  void release();
  XrAction make_action(const char* name, const char* shown, XrActionType type);

  Session& session_;
  const Api& api_;
  std::array<XrPath, 2> paths_;  // the hands' paths
  XrActionSet set_ = XR_NULL_HANDLE;
  XrAction pose_ = XR_NULL_HANDLE, stick_ = XR_NULL_HANDLE, grab_ = XR_NULL_HANDLE, menu_ = XR_NULL_HANDLE;
  XrAction gaze_ = XR_NULL_HANDLE;  // where the runtime has eye tracking
  std::array<XrSpace, 2> spaces_{};
  XrSpace gaze_space_ = XR_NULL_HANDLE;
};

}  // namespace binosplat::xr
