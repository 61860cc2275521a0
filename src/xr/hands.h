#pragma once
// Controllers and eye tracking through OpenXR's actions. Without devices, the input is at rest.

#include "xr/session.h"
#include "xr/walk.h"

namespace binosplat::xr {

struct Input {
  std::array<Hand, 2> hands;
  bool resets = false;          // the menu button was pressed
  std::optional<XrPosef> gaze;  // in the session's space; none: no eye tracking
};

class Hands {
 public:
  explicit Hands(const Session& session);

  /// Predicts hands and gaze for time `display`, and reads the current actions.
  Input read(XrTime display);

 private:
  Owned<XrAction> make_action(const char* name, const char* shown, XrActionType type, bool of_hands = true);
  Owned<XrSpace> make_space(const Owned<XrAction>& action, XrPath hand) const;
  void suggest_bindings();

  const Session& session_;
  std::array<XrPath, 2> paths_;
  Owned<XrActionSet> set_;
  Owned<XrAction> pose_, stick_, grab_, menu_;
  Owned<XrAction> gaze_;  // null without eye tracking, as is gaze_space_
  std::array<Owned<XrSpace>, 2> spaces_;
  Owned<XrSpace> gaze_space_;
};

}  // namespace binosplat::xr
