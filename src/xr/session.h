#pragma once
// An OpenXR session: its states, its reference space, and its frames.

#include <binosplat/renderer.h>

#include "xr/openxr.h"

namespace binosplat::xr {

constexpr XrPosef no_move = {{0.0f, 0.0f, 0.0f, 1.0f}, {0.0f, 0.0f, 0.0f}};

/// Returns the function loader of the current OpenGL context, which EGL or GLX has created.
GetProcAddress get_proc_address();

class Session {
 public:
  /// Begins a session with the current OpenGL context, which must stay current: EGL's if the runtime takes
  /// that (Instance::takes_egl), else GLX's. Throws Error(no_gl) if the runtime refuses it.
  explicit Session(const Instance& instance);

  const Instance& instance() const { return instance_; }
  XrSession handle() const { return session_.get(); }
  /// x right, y up, z backward, metres. The origin is on the floor, or at the head's first position.
  XrSpace space() const { return space_.get(); }
  bool on_floor() const { return space_type_ != XR_REFERENCE_SPACE_TYPE_LOCAL; }
  /// Whether the space is the room's. The head does not start at a room's origin.
  bool on_stage() const { return space_type_ == XR_REFERENCE_SPACE_TYPE_STAGE; }

  /// Handles pending events, and begins and ends the session accordingly. Returns false after the session's
  /// end. Throws Lost.
  bool poll();
  /// Whether the runtime expects frames.
  bool running() const { return running_; }
  /// Whether visibility masks have changed since the last call.
  bool take_masks_changed() { return std::exchange(masks_changed_, false); }
  /// Requests the end of the session, which the runtime carries out later.
  void request_exit();

  /// Waits for the next frame. Returns its display time, and whether it must be drawn.
  XrFrameState begin_frame() const;
  /// The predicted views; empty while the head is not tracked.
  std::vector<XrView> locate(XrTime display) const;
  /// The predicted pose of another space's origin; none if unknown.
  std::optional<XrPosef> locate(XrSpace other, XrTime display) const;
  /// Submits a layer, or an empty frame.
  void end_frame(XrTime display, const XrCompositionLayerProjection* layer = nullptr) const;

 private:
  void make_space();
  void follow(const XrEventDataSessionStateChanged& event);

  const Instance& instance_;
  Owned<XrSession> session_;
  XrReferenceSpaceType space_type_ = XR_REFERENCE_SPACE_TYPE_LOCAL;  // which every runtime offers
  Owned<XrSpace> space_;
  bool running_ = false, over_ = false, masks_changed_ = false;
};

}  // namespace binosplat::xr
