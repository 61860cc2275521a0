#pragma once
// An OpenXR session: its states, the space that heads are located in, and frames.

#include <binosplat/renderer.h>

#include "xr/openxr.h"

namespace binosplat::xr {

constexpr XrPosef no_move = {{0.0f, 0.0f, 0.0f, 1.0f}, {0.0f, 0.0f, 0.0f}};

/// How the functions of the OpenGL context that is current are found. Throws Error(no_gl) where it is not one
/// of EGL.
GetProcAddress get_proc_address();

class Session {
 public:
  /// Begins a session with the OpenGL context that is current, which must stay so. Throws Error(no_gl) for a
  /// runtime that does not take it.
  explicit Session(const Instance& instance);

  const Instance& instance() const { return instance_; }
  XrSession handle() const { return session_.get(); }
  /// x right, y up, z backward, metres. Its origin lies on the floor, or where the head was.
  XrSpace space() const { return space_.get(); }
  bool on_floor() const { return space_type_ != XR_REFERENCE_SPACE_TYPE_LOCAL; }
  /// Whether the space is the room's, whose middle is not where a head is at first.
  bool on_stage() const { return space_type_ == XR_REFERENCE_SPACE_TYPE_STAGE; }

  /// Takes the events that have come, and begins and ends the session as they ask. False once it is over.
  /// Throws Lost.
  bool poll();
  /// Whether frames are to be waited for.
  bool running() const { return running_; }
  /// Whether the visibility masks were changed since the last call.
  bool take_masks_changed() { return std::exchange(masks_changed_, false); }
  /// The user wants to leave: the runtime ends the session in its own time.
  void request_exit();

  /// Waits until the next frame is to be drawn: when it will be seen, and whether anybody looks.
  XrFrameState begin_frame() const;
  /// Where the eyes will be; nothing while the head is not tracked.
  std::vector<XrView> locate(XrTime display) const;
  /// Where another space's origin will be; nothing while that is not known.
  std::optional<XrPosef> locate(XrSpace other, XrTime display) const;
  /// Shows a layer, or nothing.
  void end_frame(XrTime display, const XrCompositionLayerProjection* layer = nullptr) const;

 private:
  void make_space();
  void follow(const XrEventDataSessionStateChanged& event);

  const Instance& instance_;
  Owned<XrSession> session_;
  XrReferenceSpaceType space_type_ = XR_REFERENCE_SPACE_TYPE_LOCAL;  // which every runtime has
  Owned<XrSpace> space_;
  bool running_ = false, over_ = false, masks_changed_ = false;
};

}  // namespace binosplat::xr
