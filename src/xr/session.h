#pragma once
// An OpenXR session: its states, the space that heads are located in, and frames.

#include <optional>
#include <vector>

#include "xr/instance.h"

namespace binosplat::xr {

constexpr XrPosef no_move = {{0.0f, 0.0f, 0.0f, 1.0f}, {0.0f, 0.0f, 0.0f}};

/// What the next frame is for.
struct FrameTime {
  XrTime display = 0;     // when it is seen
  XrDuration period = 0;  // ns, from one frame to the next
  bool is_shown = false;  // false: nobody looks, nothing need be drawn
};

class Session {
 public:
  /// Begins a session with the OpenGL context that is current, which must stay so. Throws Error(no_gl) for a
  /// runtime that does not take it.
  explicit Session(const Instance& instance);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  const Instance& instance() const { return instance_; }
  XrSession handle() const { return session_; }
  /// x right, y up, z backward, metres. Its origin lies on the floor, or where the head was.
  XrSpace space() const { return space_; }
  bool on_floor() const { return on_floor_; }
  /// Whether the space is the room's, whose middle is not where a head is at first.
  bool on_stage() const { return on_stage_; }

  /// Takes the events that have come, and begins and ends the session as they ask. False once it is over.
  /// Throws Lost.
  bool poll();
  /// Whether frames are to be waited for.
  bool running() const { return running_; }
  /// Whether the program gets what hands do.
  bool focused() const { return state_ == XR_SESSION_STATE_FOCUSED; }
  /// Whether the space was moved or replaced since the frame for which this was asked last: the frame shown
  /// at `display` then continues none.
  bool take_recentred(XrTime display);
  /// Whether the visibility masks were changed since the last call.
  bool take_masks_changed();
  /// The user wants to leave: the runtime ends the session in its own time.
  void request_exit();

  FrameTime begin_frame();
  /// Where the eyes will be; nothing while the head is not tracked.
  std::vector<XrView> locate(XrTime display);
  /// Where another space's origin will be; nothing while that is not known.
  std::optional<XrPosef> locate(XrSpace other, XrTime display);
  /// Shows a layer, or nothing.
  void end_frame(const FrameTime& frame, const XrCompositionLayerBaseHeader* layer);

 private:
  void make_space();
  void follow(const XrEventDataSessionStateChanged& event);
  void begin();

  const Instance& instance_;
  const Api& api_;
  XrSession session_ = XR_NULL_HANDLE;
  XrSpace space_ = XR_NULL_HANDLE;
  XrEnvironmentBlendMode blend_mode_ = XR_ENVIRONMENT_BLEND_MODE_OPAQUE;
  XrSessionState state_ = XR_SESSION_STATE_UNKNOWN;
  std::optional<XrTime> changes_at_;  // the space
  bool on_floor_ = false, on_stage_ = false, running_ = false, over_ = false, masks_changed_ = false;
};

}  // namespace binosplat::xr
