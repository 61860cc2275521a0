#pragma once
// The cost of a drawn frame, and how much the next one may draw within its time.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace binosplat {

struct StageTime {
  std::string name = {};  // decode, project, bin, sort, blend, probe
  double ms = 0;          // on the GPU
};

/// When the GPU was at a stage, in ns on its own clock, which GL_TIMESTAMP tells. A stage may come more than
/// once.
struct StageSpan {
  std::string name = {};
  std::int64_t begin_ns = 0, end_ns = 0;
};

/// Times are sums over all attempts at a quality, without drawings for which a buffer was too small. They
/// exclude writes into targets after the blend.
struct Report {
  std::vector<StageTime> stages = {};  // empty where the driver tells no times
  double gpu_ms = 0;                   // their sum
  std::vector<StageSpan> spans = {};   // of all drawings, one after the other
  double plan_ms = 0;    // CPU time of deciding what is drawn, which submit() takes, as are the next two:
  double upload_ms = 0;  // of handing parameters to the driver
  double submit_ms = 0;  // of handing it the stages, with shaders that had to be compiled
  double wait_ms = 0;    // CPU time that finish() waits for the GPU
  double read_ms = 0;    // and that it takes to read back what the GPU counted and timed
  std::int64_t gpu_bytes = 0;  // in the renderer's buffers, the model's included

  std::uint64_t visible = 0;  // Gaussians drawn, summed over the order groups
  std::uint64_t pairs = 0;    // (Gaussian, tile) over all views
  /// Depth orders: one where the views look the same way from the same depth, as those of parallel eyes do.
  std::uint32_t order_groups = 0;

  float tolerance = 0.0f;  // that the frame was drawn with; 0: it is exact
  /// With Settings::quality: the PSNR in dB of the view that errs most, by what this frame and earlier ones
  /// measured; infinite where nothing differs.
  double quality = 0.0;
  bool quality_is_estimate = false;  // not measured on all of this frame: it may be some dB off
  int attempts = 0;                  // times that it was drawn until the quality held
  int redrawn = 0;                   // times that it was drawn again, since a buffer was too small
  int programs_made = 0;             // shaders that were compiled for it, or loaded from the cache
  bool used_measured = false;        // it used the transmittance that an earlier frame measured
  bool sampled_error = false;        // it drew some tiles exactly, too, to measure its error
  /// With a quality or a measured transmittance: it could not go by earlier frames, as the first one cannot,
  /// nor one after a camera cut.
  bool is_cut = false;

  /// All pictures were blended straight into their targets. Not where there are more than 4 views, a layout
  /// other than `separate` or a target that takes a copy, nor in frames that measure the error for a quality:
  /// these are blended into a buffer of the renderer's, and from there written into the targets.
  bool in_place = false;
  /// OpenGL errors that were recorded before the frame began: the caller's own. The frame is drawn all the
  /// same.
  std::vector<std::uint32_t> callers_errors = {};
};

/// How much is drawn.
struct Effort {
  std::optional<float> quality = {};  // dB, as Settings::quality; none: exactly
  double scale = 1.0;                 // both sides of the pictures over those asked for
};

/// As much quality as a frame's time allows: exact frames where these are in time; else less quality, down to
/// 37 dB, and then smaller pictures, down to half of both sides.
///
///   binosplat::FrameBudget budget(0.8 * period_ms);  // an OpenXR runtime draws, too
///   // Each frame:
///   const binosplat::Effort effort = budget.effort();
///   // ... views of effort.scale times the pixels along each side, drawn with effort.quality ...
///   budget.took(renderer.finish().gpu_ms, period_ms);
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
