#pragma once
// --frame-budget: as much quality as a frame's time allows.

#include "render/settings.h"

namespace binosplat::xr {

/// How much is drawn.
struct Effort {
  float quality = 0.0f;  // dB, as FrameSettings; 0: exactly
  double scale = 1.0;    // both sides of the pictures over those asked for
};

/// Exact frames where these are in time; else less quality, down to 37 dB, and then smaller pictures, down to
/// half of both sides.
class Budget {
 public:
  /// A frame may take `ms`.
  explicit Budget(double ms) : ms_(ms) {}

  Effort effort() const;

  /// A frame of this effort took `ms`, where the runtime shows one every `period_ms`. The first of an effort
  /// does not count. One that is late by a third, or two in a row that are late, lessen the effort. A second
  /// of frames that take less than three quarters of the time raises it again; after each raise that was too
  /// much, the next one takes twice as many seconds, up to 32.
  void took(double ms, double period_ms);

 private:
  static constexpr double wait_least_ms = 1000.0;
  void set(int step);

  double ms_;
  int step_ = 0;  // less and less effort
  int late_ = 0;  // frames in a row
  bool fresh_ = true, raised_ = false;
  double early_ms_ = 0.0, since_raised_ms_ = 0.0, wait_ms_ = wait_least_ms;
};

}  // namespace binosplat::xr
