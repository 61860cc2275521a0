#pragma once
// Controllers and eyes as OpenXR's actions have them. Without any, all is at rest.

#include "xr/session.h"
#include "xr/walk.h"

namespace binosplat::xr {

/// What the user does at a moment.
struct Input {
  std::array<Hand, 2> hands;
  bool resets = false;          // the menu button was pushed
  std::optional<XrPosef> gaze;  // in the session's space; none where no eye tracker tells
};

class Hands {
 public:
  explicit Hands(const Session& session);

  /// Where hands and gaze will be at that time, and what hands do now.
  Input read(XrTime display);

 private:
  Owned<XrAction> make_action(const char* name, const char* shown, XrActionType type, bool of_hands = true);
  Owned<XrSpace> make_space(const Owned<XrAction>& action, XrPath hand) const;
  void suggest_bindings();

  const Session& session_;
  std::array<XrPath, 2> paths_;  // the hands' paths
  Owned<XrActionSet> set_;
  Owned<XrAction> pose_, stick_, grab_, menu_;
  Owned<XrAction> gaze_;  // null where the runtime has no eye tracking, and so is its space
  std::array<Owned<XrSpace>, 2> spaces_;
  Owned<XrSpace> gaze_space_;
};

}  // namespace binosplat::xr
