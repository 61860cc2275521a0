#pragma once
// Report is the cost of a drawn frame. FrameBudget chooses the quality and size of frames by their time.

#include <binosplat/settings.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace binosplat {

struct StageTime {
  std::string name = {};  // decode, project, bin, sort, blend, probe; in foveated frames also compose
  double ms = 0;          // on the GPU
};

/// When the GPU ran a stage, in ns on its own clock (GL_TIMESTAMP). A stage may occur more than once.
struct StageSpan {
  std::string name = {};
  std::int64_t begin_ns = 0, end_ns = 0;

  double ms() const { return 1e-6 * static_cast<double>(end_ns - begin_ns); }
};

/// Why a frame with Settings::quality was drawn exactly.
enum class ExactReason {
  not_exact,   // it was drawn with a tolerance, or without a quality
  unmeasured,  // too little is known of its error: a first frame, after a camera cut, in very fast motion
  no_gain,     // a tolerance would save less than 5 % of its time
  small,       // a view has too few tiles to measure the error of a part of them
};

/// Returns the name of a reason, as in tables and files; empty for not_exact.
constexpr const char* name_of(ExactReason reason) {
  constexpr const char* names[] = {"", "unmeasured", "no gain", "small"};
  return names[static_cast<int>(reason)];
}

/// Times exclude drawings for which a buffer was too small, and writes into targets after the blend.
struct Report {
  std::vector<StageTime> stages = {};  // empty if the driver reports no times
  double gpu_ms = 0;                   // sum of the stages
  std::vector<StageSpan> spans = {};   // of all drawings, in order
  double plan_ms = 0;                  // CPU time in which submit() plans the frame
  double upload_ms = 0;                // CPU time in which submit() passes parameters to the driver
  double submit_ms = 0;        // CPU time in which submit() compiles shaders and passes stages to the driver
  double wait_ms = 0;          // CPU time in which finish() waits for the GPU
  double read_ms = 0;          // CPU time in which finish() reads back counts and times
  std::int64_t gpu_bytes = 0;  // size of the renderer's buffers, including the model's

  std::uint64_t visible = 0;  // Gaussians drawn, summed over the order groups
  std::uint64_t pairs = 0;    // pairs of a Gaussian and a tile, summed over the views and the error sample
  /// 1 if all views have the same direction and depth, as parallel eyes do.
  std::uint32_t order_groups = 0;

  Threshold threshold = Threshold::exact;  // the frame's rule; with a quality, frames may choose it
  float tolerance = 0.0f;                  // the frame's tolerance; 0: the frame is exact
  /// With Settings::quality: the PSNR in dB of the worst view, estimated from parts of this and earlier
  /// frames. Infinite for exact frames.
  double quality = 0.0;
  ExactReason exact = ExactReason::not_exact;
  int redraws = 0;             // drawings that were repeated because a buffer was too small
  int new_programs = 0;        // shaders that were compiled for the frame, or loaded from the cache
  bool used_last = false;      // the frame used transmittance that an earlier frame measured
  bool measured = false;       // the frame measured transmittance for later frames
  bool sampled_error = false;  // the frame also drew some tiles a second time, to measure its error

  /// All pictures were blended straight into their targets. False for more than 4 views, a layout other than
  /// `separate`, a target that needs a copy, and frames that measure their error for a quality. The renderer
  /// blends such pictures into its own buffer, and copies them from there.
  bool in_place = false;
  /// OpenGL errors that the caller's own commands left before the frame began. They do not stop the frame.
  std::vector<std::uint32_t> callers_errors = {};
};

/// How much work a frame does.
struct Effort {
  std::optional<float> quality = {};  // dB, as Settings::quality; none: exact
  double scale = 1.0;                 // factor of the picture's width and height
};

/// Chooses the best quality that fits a frame's time. It starts with exact frames. If they take too long, it
/// lowers the quality down to 37 dB, and then the width and height down to half.
///
///   binosplat::FrameBudget budget(0.8 * period_ms);  // the OpenXR runtime needs the rest
///   // Each frame:
///   const binosplat::Effort effort = budget.effort();
///   // Make the views effort.scale times as wide and as high; draw them with effort.quality.
///   budget.took(renderer.finish(), period_ms);
class FrameBudget {
 public:
  /// `ms` is the budget: the time that a frame may take.
  explicit FrameBudget(double ms) : ms_(ms) {}

  Effort effort() const;

  /// Records the Report::gpu_ms of a frame of the present effort; the display shows a frame every
  /// `period_ms`. Ignores the first frame after each change, which may compile shaders, and up to 16 frames
  /// in a row that are exact because their error is unmeasured. Lowers the effort after one frame that
  /// exceeds the budget by a third, or after two frames in a row that exceed it. Raises the effort after a
  /// second of frames that take less than three quarters of the budget. If a raise was too much, the wait
  /// before the next raise doubles, up to 32 s.
  void took(const Report& frame, double period_ms);

 private:
  static constexpr double min_wait_ms = 1000.0;
  void set(int step);

  double ms_;
  int step_ = 0;        // index of the effort; 0 is the highest
  int late_ = 0;        // late frames in a row
  int unmeasured_ = 0;  // frames in a row that are exact because their error is unmeasured
  bool fresh_ = true, raised_ = false;
  double early_ms_ = 0.0, since_raised_ms_ = 0.0, wait_ms_ = min_wait_ms;
};

}  // namespace binosplat
