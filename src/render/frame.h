#pragma once
// Draws a model in one or more views (such as both eyes of a rig) by compute shaders. The CPU reads nothing
// back before the end of a frame.

#include <binosplat/report.h>

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/image.h"
#include "gl/dispatch.h"
#include "render/buffers.h"
#include "render/debug_options.h"
#include "render/frame_settings.h"
#include "render/gpu_model.h"
#include "render/history.h"
#include "render/memory.h"
#include "render/stages.h"
#include "render/tolerance_control.h"

namespace binosplat::render {

/// The frame's quality; none without settings.quality.
inline std::optional<double> measured_quality(const Report& report) {
  return report.quality > 0.0 ? std::optional(report.quality) : std::nullopt;
}

/// A Gaussian that a frame drew in a view, and its largest transmittance.
struct MeasuredGaussian {
  std::uint32_t index = 0;     // in the model
  float depth = 0.0f;          // world units: view z, or with Projection::tangent the distance from the eye
  float transmittance = 0.0f;  // max(T), not raised to BOUND_FLOOR; 0 if no pixel blends the Gaussian
};

class Frame {
 public:
  /// Several Frames may draw one model; each has its own buffers and history. The context must be current in
  /// every call.
  explicit Frame(std::shared_ptr<GpuModel> model);
  /// Uploads the model for this Frame alone. The model must outlive the Frame. Throws as GpuModel does.
  Frame(gl::Context& context, const Model& model, int precision = PRECISION_FULL)
      : Frame(std::make_shared<GpuModel>(context, model, precision)) {}

  /// Sets the instances of the next frames; without this call, they draw the Frame's own model in its own
  /// world. Throws Error for a Scaffold-GS model that is moved, or not the only instance.
  void place(std::vector<Instance> instances);

  /// Draws all views at once and waits for the GPU. Successive views in which each point has the same depth
  /// (`row_z` and anchor are bit-equal) are projected together. In full precision an eye of a rig has the
  /// same bits alone and with the other eye. After GpuModel::reload() the tolerance stays, but measured
  /// transmittance is dropped. Throws Error: bad views or settings (bad_input), no memory (out_of_memory).
  ///
  /// With canvases, the blend writes pictures into them instead of into colours(). It writes final depths
  /// into z_sums(): one row of every `depth_rows` (1 or 2), and 0 for a pixel without depth. A frame with a
  /// probe or a stand-in (DebugOptions::stand_in) still writes into colours(); Report::in_place is
  /// then false.
  ///
  /// With mesh depths, splats behind meshes are not drawn, and z_sums() always has final depths. A pixel that
  /// is at most half covered has the mesh's depth. Mesh depths with measured T or a stand-in are errors.
  Report draw(std::span<const shared::View> views, const FrameSettings& settings = {},
              const DebugOptions& debug = {}, const CallersTextures& textures = {}) {
    submit(views, settings, debug, textures);
    return finish();
  }

  /// Passes a frame to the driver, as draw() does, and returns while the GPU draws. Call finish() before this
  /// Frame's next frame, and before reading any result.
  void submit(std::span<const shared::View> views, const FrameSettings& settings = {},
              const DebugOptions& debug = {}, const CallersTextures& textures = {});

  /// Compiles every program that frames of these settings may need, also to measure, and allocates the
  /// frames' memory. Draws nothing. The next frame uses no earlier measurements.
  void prepare(std::span<const shared::View> views, const FrameSettings& settings,
               const DebugOptions& debug = {}, const CallersTextures& textures = {});

  /// Whether the GPU has finished the frame. finish() draws it again if a buffer was too small.
  bool is_done() { return dispatcher_.is_done(); }

  /// Waits for the frame. Draws the frame again if a buffer was too small.
  Report finish();

  /// Draws with settings.tolerance, whatever the quality, and ends after stage `last`, whose results
  /// are in buffers(). `exact` as in FramePlan. Later frames use no measurements of a frame that ended early.
  Report draw_until(Stage last, std::span<const shared::View> views, const FrameSettings& settings = {},
                    const DebugOptions& debug = {}, const std::optional<Probe>& probe = {},
                    bool exact = false);

  /// The pictures of the last frame, one per view. If a stand-in replaced the blend, they have the mean
  /// depth, whatever the settings say.
  std::vector<Picture> read_pictures() const;

  /// The pictures of a stand-in for the blend, which never were on the GPU.
  const std::vector<Picture>& stand_in_pictures() const { return stand_in_pictures_; }

  /// The next frame uses no earlier measurements.
  void forget() { history_.forget(); }

  /// Same as forget(), and drops the tolerance that was found for a quality.
  void start_over() {
    forget();
    tolerance_control_ = {};
  }

  /// The measurements of the last frame in its view `v`, in index order. Empty if the frame did not measure
  /// (Report::measured), for placed instances, and after a reload of the model.
  std::vector<MeasuredGaussian> read_measured(std::uint32_t v) const;

  /// A debug view of the last frame, SHOW_ALPHAS to SHOW_MEDIAN_DEPTH of shared/choices.h: one image of one
  /// channel per view, below 0 for a pixel without a value. Walks the frame's lists again. Throws Error if a
  /// stand-in replaced the blend, because its lists are not on the GPU.
  std::vector<Image> read_debug_view(int what);

  const std::shared_ptr<GpuModel>& model() const { return model_; }
  /// The pictures on the GPU: vec4 (C, T) by pixel; each view begins at its pixel_offset. Undefined if a
  /// stand-in replaced the blend, and for a frame on canvases.
  const gl::Buffer& colours() const { return buffers_.pictures.colours; }
  /// Z of each pixel, in the order of colours(). For frames on canvases or with mesh depths: final depths,
  /// see draw(). Undefined without FrameSettings::has_depths.
  const gl::Buffer& z_sums() const { return buffers_.pictures.z_sums; }
  /// The views of the last frame, with tiles, offsets and groups; a probe's comes last.
  const std::vector<shared::View>& views() const { return plan_.views; }
  const FramePlan& plan() const { return plan_; }
  FrameBuffers& buffers() { return buffers_; }
  /// The buffers of the first drawn model. Valid after the first frame.
  ModelBuffers& model_buffers() { return *model_buffers_.front(); }

 private:
  /// The arguments of submit().
  struct Submitted {
    std::vector<shared::View> views;
    FrameSettings settings;
    DebugOptions debug;
    std::vector<Canvas> canvases;
    std::vector<MeshDepth> mesh_depths;
    int depth_rows = 1;
    Stage last = Stage::probe;
  };

  CallersTextures submitted_textures(bool with_canvases) const;
  void store_submission(std::span<const shared::View> views, const FrameSettings& settings,
                        const DebugOptions& debug, const CallersTextures& textures);
  void start_report();
  void begin(PlanRequest request);
  void begin(const ToleranceControl::Choice& choice);
  void start_drawing();
  void wait_and_read();
  std::uint32_t parts_of_lists() const;
  void reserve();
  void record();
  void record_stages();
  const Report& finish_drawing();

  struct Drawn {
    std::shared_ptr<GpuModel> model;
    int uploads = 0;  // GpuModel::uploads() at the last frame
    std::uint32_t instances = 1;
  };
  bool is_plain() const { return places_.empty(); }

  std::shared_ptr<GpuModel> model_;
  std::vector<Drawn> drawn_;           // each model once
  std::vector<InstancePlace> places_;  // FramePlan::instances
  /// The buffers of drawn_[i].model, at the same i. Empty until a frame draws these models.
  std::vector<std::shared_ptr<ModelBuffers>> model_buffers_;
  gl::Dispatcher dispatcher_;
  FrameBuffers buffers_;
  bool is_prepared_ = false;  // prepare() or a frame has compiled the programs
  Submitted submitted_;
  FramePlan plan_;
  Measuring measuring_;
  gl::Buffer counters_read_;                        // Counters
  Report report_;                                   // of the frame since submit()
  int programs_before_ = 0;                         // Context::program_count() at submit()
  std::optional<ToleranceControl::Choice> choice_;  // of the last frame, with settings.quality
  double unseen_change_ = 0.0;    // of the models since the last frame, as a share of a camera cut
  shared::Counters counters_{};   // of the last drawing
  std::uint32_t list_parts_ = 1;  // FramePlan::list_parts of later frames
  ListMeans list_means_;          // of the last drawing
  Capacity capacity_;
  FrameHistory history_;
  ToleranceControl tolerance_control_;
  std::vector<Picture> stand_in_pictures_;  // of a stand-in for the blend
};

}  // namespace binosplat::render
