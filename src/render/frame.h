#pragma once
// Draws a model in one or more views (such as both eyes of a rig) by compute shaders. The CPU reads nothing
// back before the end of a frame.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/image.h"
#include "gl/dispatch.h"
#include "render/buffers.h"
#include "render/debug_options.h"
#include "render/gpu_model.h"
#include "render/history.h"
#include "render/memory.h"
#include "render/settings.h"
#include "render/tolerance_control.h"

namespace binosplat::render {

/// CPU times of a frame, in ms.
struct CpuTimes {
  double plan = 0;    // plans the frame
  double upload = 0;  // passes buffers and parameters to the driver
  double submit = 0;  // passes the stages to the driver, and makes programs
  double wait = 0;    // waits for the GPU
  double read = 0;    // reads back counts and times

  double sum() const { return plan + upload + submit + wait + read; }
};

/// The cost and the properties of a drawn frame.
struct FrameReport {
  std::uint64_t visible = 0;          // Gaussians drawn, summed over the order groups (1 for parallel eyes)
  std::uint64_t pairs = 0;            // Gaussian-tile pairs over all views, including a probe's
  std::uint64_t supertile_pairs = 0;  // sorted entries: pairs with supertiles; both eyes may share one
  std::uint32_t order_groups = 0;
  int attempts = 0;                   // with settings.quality: drawings until the frame reached it
  int redrawn = 0;                    // drawings that were repeated because a buffer was too small
  std::vector<gl::StageTime> stages;  // GPU time of the complete drawing, summed over attempts
  double total_ms = 0;                // their sum
  std::vector<gl::StageSpan> spans;   // spans of all stages, also of drawings that overflowed
  CpuTimes cpu;                       // of all drawings
  int programs_made = 0;              // programs that were compiled for the frame, or loaded from the cache
  std::int64_t gpu_bytes = 0;         // in buffers, including the model's
  int tile_size = 0;                  // px
  float tolerance = 0.0f;             // K or kappa of the frame
  bool used_measured = false;         // the frame used the transmittance that an earlier one measured
  bool measured = false;              // the frame measured transmittance for later frames
  bool sampled_error = false;         // the frame also drew some tiles exactly, to measure its error
  bool is_cut = false;  // no earlier measurements could be used: it is the first, or follows a camera cut
  bool on_canvases = false;  // the pictures are on the caller's canvases only
  double quality = 0.0;      // with settings.quality: PSNR in dB, from this frame's and earlier probes
  bool quality_is_estimate = false;  // measured on a part of this frame
};

/// A Gaussian that a frame drew in a view, and its largest transmittance.
struct MeasuredGaussian {
  std::uint32_t index = 0;     // in the model
  float depth = 0.0f;          // view z, with PROJECTION_TANGENT the distance, in world units
  float transmittance = 0.0f;  // max(T) without the lower limit of the bounds; 0 if no pixel blends it
};

class Frame {
 public:
  /// Several Frames may draw one model; each has its own buffers and history. The context must be current in
  /// every call.
  explicit Frame(std::shared_ptr<GpuModel> model);
  /// Uploads the model for this Frame alone; the model must outlive it. Throws as GpuModel does.
  Frame(gl::Context& context, const Model& model, int precision = PRECISION_FULL)
      : Frame(std::make_shared<GpuModel>(context, model, precision)) {}

  /// Sets the models that the next frames draw, and their places. Initially it is the Frame's own model, once
  /// and in its own world. All instances are sorted and blended together. Throws Error for a
  /// Scaffold-GS model that is not alone in its own world.
  void place(std::vector<Instance> instances);

  /// Draws all views at once and waits for the GPU: submit() and finish(). Neighbouring views with equal
  /// depths (third row and anchor are bit-equal) are projected together. Each eye of a rig has the same bits,
  /// drawn together with the other or alone. If a buffer overflows, it grows and the frame is drawn again.
  /// After GpuModel::reload() the tolerance stays, but measured transmittance is dropped. Throws Error: bad
  /// views or settings (bad_input), no memory (out_of_memory).
  ///
  /// With canvases, the blend writes pictures there instead of into colours(). It writes depths into
  /// z_sums(): one row of every `depth_rows` (1 or 2), 0 for a pixel without depth. It writes into colours()
  /// as usual for a probe, a stand-in of the blend, and a tile size other than the default.
  /// FrameReport::on_canvases reports which.
  ///
  /// With mesh depths, splats behind meshes are not drawn, and z_sums() always has depths. A pixel that is at
  /// most half covered has the mesh's. Excludes measured transmittance and stand-ins.
  FrameReport draw(std::span<const shared::View> views, const FrameSettings& settings = {},
                   const DebugOptions& debug = {}, const CallersTextures& textures = {}) {
    submit(views, settings, debug, textures);
    return finish();
  }

  /// Passes a frame as of draw() to the driver and returns while the GPU draws. Call finish() before the next
  /// frame of this Frame, and before reading anything of this one.
  void submit(std::span<const shared::View> views, const FrameSettings& settings = {},
              const DebugOptions& debug = {}, const CallersTextures& textures = {});

  /// Compiles every program that frames of these settings may need, including those that measure, and
  /// allocates their memory. Draws nothing. The next frame uses no earlier measurements.
  void prepare(std::span<const shared::View> views, const FrameSettings& settings,
               const DebugOptions& debug = {}, const CallersTextures& textures = {});

  /// Whether the GPU has finished the frame. finish() may still have to draw it again.
  bool is_done() { return dispatcher_.is_done(); }

  /// Waits for the frame. Draws it again if a buffer was too small or its quality missed.
  FrameReport finish();

  /// Same as draw() with settings.tolerance, but ends after stage `last`, whose results are in buffers(). The
  /// next frame uses measurements of complete frames only.
  FrameReport draw_until(Stage last, std::span<const shared::View> views, const FrameSettings& settings = {},
                         const DebugOptions& debug = {}, const std::optional<Probe>& probe = {});

  /// The pictures of the last frame, one per view. If a stand-in replaced the blend, they have the mean
  /// depth, whatever the settings say.
  std::vector<Picture> read_pictures() const;

  /// The pictures of a stand-in for the blend, which never were on the GPU.
  const std::vector<Picture>& stand_in_pictures() const { return stand_in_pictures_; }

  /// The next frame uses no earlier measurements.
  void forget() { history_.forget(); }

  /// The next frame is drawn as the first one: it also drops the tolerance that was found for a quality.
  void start_over() {
    forget();
    tolerance_control_ = {};
  }

  /// The measurements of the last frame in its view `v`, in index order. Empty if it did not measure
  /// (FrameReport), and after a reload of the model.
  std::vector<MeasuredGaussian> read_measured(std::uint32_t v) const;

  /// A debug view of the last frame, SHOW_ALPHAS to SHOW_MEDIAN_DEPTH of shared/axes.h: one image of one
  /// channel per view, below 0 for a pixel without a value. Walks the frame's lists again. Throws Error if a
  /// stand-in replaced the blend: its lists are not on the GPU.
  std::vector<Image> read_debug_view(int what);

  const std::shared_ptr<GpuModel>& model() const { return model_; }
  /// The pictures on the GPU: vec4 (C, T) by pixel; each view begins at its pixel_offset. Undefined if a
  /// stand-in replaced the blend, and for a frame on canvases.
  const gl::Buffer& colours() const { return buffers_.pictures.colours; }
  /// Z by pixel, in the same order. For a frame on canvases: depths, see draw(). Undefined with Depth::none.
  const gl::Buffer& z_sums() const { return buffers_.pictures.z_sums; }
  /// The views of the last frame, with tiles, offsets and groups; a probe's comes last.
  const std::vector<shared::View>& views() const { return plan_.views; }
  const FramePlan& plan() const { return plan_; }
  FrameBuffers& buffers() { return buffers_; }
  /// The first drawn model's. Valid once a frame was drawn.
  ModelBuffers& model_buffers() { return *model_buffers_.front(); }

 private:
  /// The arguments of submit(), for further attempts.
  struct Submitted {
    std::vector<shared::View> views;
    FrameSettings settings;
    DebugOptions debug;
    std::vector<Canvas> canvases;
    std::vector<MeshDepth> mesh_depths;
    int depth_rows = 1;
    Stage last = Stage::probe;
    bool searches = false;  // whether it searches the tolerance for its quality: each attempt has a probe
  };

  CallersTextures submitted_textures(bool with_canvases) const;
  void store_submission(std::span<const shared::View> views, const FrameSettings& settings,
                        const DebugOptions& debug, const CallersTextures& textures);
  void start_report();
  void begin(PlanRequest request);
  void start_search();
  void start_attempt();
  void wait_and_read(FrameReport& report);
  void reserve();
  void record();
  void record_stages();
  FrameReport finish_attempt();
  void fill(FrameReport& report) const;

  /// A model that is drawn.
  struct Drawn {
    std::shared_ptr<GpuModel> model;
    int uploads = 0;  // GpuModel::uploads() at the last frame
    std::uint32_t instances = 1;
  };
  bool is_plain() const { return places_.empty(); }

  std::shared_ptr<GpuModel> model_;
  std::vector<Drawn> drawn_;           // each model once
  std::vector<InstancePlace> places_;  // FramePlan::instances
  /// Of drawn_; empty until a frame draws these models.
  std::vector<std::shared_ptr<ModelBuffers>> model_buffers_;
  gl::Dispatcher dispatcher_;
  FrameBuffers buffers_;
  bool is_prepared_ = false;  // prepare() has compiled its programs
  Submitted submitted_;
  FramePlan plan_;
  Measuring measuring_;
  gl::Buffer counters_read_;     // Counters
  CpuTimes cpu_;                 // of the frame since submit()
  int programs_before_ = 0;      // Context::programs_made() at submit()
  bool is_cut_ = false;          // see FrameReport
  shared::Counters counters_{};  // of the last drawing
  double tiles_a_splat_ = 0.0;   // tiles per splat of the last drawing
  Capacity capacity_;
  FrameHistory history_;
  ToleranceControl tolerance_control_;
  std::vector<Picture> stand_in_pictures_;  // of a stand-in for the blend
};

}  // namespace binosplat::render
