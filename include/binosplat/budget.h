#pragma once
// As much quality as a frame's time allows.
//
//   binosplat::FrameBudget budget(0.8 * period_ms);  // the runtime draws, too
//   // Each frame:
//   const binosplat::Effort effort = budget.effort();
//   // ... views of effort.scale times the pixels along each side, drawn with effort.quality ...
//   budget.took(renderer.finish().gpu_ms, period_ms);

#include <optional>

namespace binosplat {

/// How much is drawn.
struct Effort {
  std::optional<float> quality = {};  // dB, as Settings::quality; none: exactly
  double scale = 1.0;                 // both sides of the pictures over those asked for
};

/// Exact frames where these are in time; else less quality, down to 37 dB, and then smaller pictures, down to
/// half of both sides.
class FrameBudget {
 public:
  /// A frame may take `ms`.
  explicit FrameBudget(double ms) : ms_(ms) {}

  Effort effort() const;

  /// A frame of this effort took `ms` (Report::gpu_ms), where one is shown every `period_ms`. The first of an
  /// effort does not count. One that is late by a third, or two in a row that are late, lessen the effort. A
  /// second of frames that take less than three quarters of the time raises it again; after each raise that
  /// was too much, the next one takes twice as many seconds, up to 32.
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

}  // namespace binosplat
