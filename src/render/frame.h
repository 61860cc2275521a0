#pragma once
// One frame: a model drawn in one or more views (both eyes of a rig) by compute shaders, without a read-back
// inside.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/image.h"
#include "gl/dispatch.h"
#include "render/buffers.h"
#include "render/gpu_model.h"
#include "render/history.h"
#include "render/memory.h"
#include "render/settings.h"
#include "render/tolerance_control.h"
#include "render/workings.h"

namespace binosplat::render {

/// CPU time of a frame, in ms.
struct CpuTimes {
  double plan = 0;    // to decide what is drawn
  double upload = 0;  // to hand buffers and parameters to the driver
  double submit = 0;  // to hand it the stages; with programs that had to be made
  double wait = 0;    // for the GPU
  double read = 0;    // to read back what it counted and timed

  double sum() const { return plan + upload + submit + wait + read; }
};

/// What drawing a frame took.
struct FrameReport {
  std::uint64_t visible = 0;          // Gaussians drawn, summed over the order groups (1 for parallel eyes)
  std::uint64_t pairs = 0;            // Gaussian-tile pairs over all views, a probe's included
  std::uint64_t supertile_pairs = 0;  // sorted, of supertiles of 2 x 2 tiles; for both eyes one
  std::uint32_t order_groups = 0;
  int attempts = 0;  // with settings.quality: how often the frame was drawn until it reached that
  int redrawn = 0;   // times that buffers had to grow
  std::vector<gl::StageTime> stages;  // GPU time of the complete drawing, summed over attempts
  double total_ms = 0;                // their sum
  std::vector<gl::StageSpan> spans;   // when these were drawn; of drawings that overflowed, too
  CpuTimes cpu;                       // of all drawings
  int programs_made = 0;              // that were compiled for it, or loaded from the cache
  std::int64_t gpu_bytes = 0;         // in buffers, the model's included
  int tile_size = 0;                  // px
  float tolerance = 0.0f;             // K or kappa that the frame was drawn with
  bool used_measured = false;         // it used the transmittance that an earlier frame measured
  bool measured = false;              // it measured for later ones
  bool sampled_error = false;         // it drew tiles exactly, too, to measure its error
  bool is_cut = false;  // it could not go by earlier frames, as it asked to: it is the first, or a camera cut
  bool on_canvases = false;  // its pictures are on the canvases that it was given, and nowhere else
  double quality = 0.0;      // with settings.quality: its PSNR in dB, as this and earlier frames' probes tell
  bool quality_is_estimate = false;  // not measured on all of this frame
};

/// A Gaussian that a frame drew in a view, and the largest transmittance that it met.
struct MeasuredGaussian {
  std::uint32_t index = 0;     // in the model
  float depth = 0.0f;          // view z, with PROJECTION_TANGENT the distance, world units
  float transmittance = 0.0f;  // max(T), not floored; 0 where no pixel blends it
};

class Frame {
 public:
  /// Frames of a model that others may draw, too: each has buffers and a history of its own. The context must
  /// be current in every call.
  explicit Frame(std::shared_ptr<GpuModel> model);
  /// The same of a model that is uploaded for this frame alone, and must outlive it. Throws as GpuModel does.
  Frame(gl::Context& context, const Model& model, int precision = PRECISION_FULL)
      : Frame(std::make_shared<GpuModel>(context, model, precision)) {}

  /// The models that the next frames draw, and where; at first the one that the Frame was made with, once and
  /// in its own world. Several share lists and are blended as one model. Throws Error for a scale or an
  /// opacity that there is not, and for a Scaffold-GS model that is not alone in its own world.
  void place(std::vector<Instance> instances);

  /// Draws all views at once, and waits for the GPU: submit() and finish(). Views that follow one another
  /// with equal depths (third row and anchor equal to the bit) are projected together; each eye of a rig has
  /// the same bits drawn together with the other or alone. A frame that overflows its buffers is drawn again
  /// with larger ones. After GpuModel::reload() a tolerance that was found stays, but no measured
  /// transmittance. Throws Error: bad views or settings (bad_input), no room (out_of_memory).
  ///
  /// With canvases the blend writes pictures there and not into colours(), and depths into z_sums(): one row
  /// of every `depth_rows` (1 or 2), 0 where a pixel has none. Where a probe needs the pictures, something
  /// stands in for the blend, or tiles have another size than the default, it writes into colours() as usual;
  /// FrameReport::on_canvases tells which.
  ///
  /// With mesh depths nothing is drawn of what lies behind them, and z_sums() has depths in any case: where
  /// half or less of a pixel is covered, the mesh's. Not with a measured transmittance, nor with a stand-in.
  FrameReport draw(std::span<const shared::View> views, const FrameSettings& settings = {},
                   const Workings& workings = {}, const CallersTextures& textures = {}) {
    submit(views, settings, workings, textures);
    return finish();
  }

  /// Hands such a frame to the driver and returns while the GPU draws. finish() must be called before the
  /// next frame of this Frame, and before anything is read of this one.
  void submit(std::span<const shared::View> views, const FrameSettings& settings = {},
              const Workings& workings = {}, const CallersTextures& textures = {});

  /// Compiles every program that frames of these settings may need, those that measure included, and takes
  /// their memory. Draws nothing; the next frame is as a first one.
  void prepare(std::span<const shared::View> views, const FrameSettings& settings,
               const Workings& workings = {}, const CallersTextures& textures = {});

  /// Whether finish() would find the GPU done. Even then it may have to draw again.
  bool is_done() { return dispatcher_.is_done(); }

  /// Waits for the frame, and draws it again where a buffer was too small or its quality missed.
  FrameReport finish();

  /// As draw() with settings.tolerance, but no further than stage `last`: what it leaves is read from
  /// buffers(). The next frame uses measurements only of frames that were drawn to their end.
  FrameReport draw_until(Stage last, std::span<const shared::View> views, const FrameSettings& settings = {},
                         const Workings& workings = {}, const std::optional<Probe>& probe = {});

  /// The pictures of the last frame drawn, one a view; where something else stood in for blend, with the mean
  /// depth whatever the settings say.
  std::vector<Picture> read_pictures() const;

  /// Those of them that never were on the GPU, because something else stood in for blend.
  const std::vector<Picture>& pictures_stood_in() const { return pictures_stood_in_; }

  /// The next frame uses nothing that earlier ones measured, as a first one does.
  void forget() { history_.forget(); }

  /// The next frame is drawn as this Frame's first one was: the tolerance that was found for a quality goes,
  /// too.
  void start_over() {
    forget();
    tolerance_control_ = {};
  }

  /// What the last frame measured in its view `v`, in index order; none unless it did (FrameReport), or after
  /// a reload of the model.
  std::vector<MeasuredGaussian> read_measured(std::uint32_t v) const;

  /// A debug view of the last frame, SHOW_ALPHAS to SHOW_MEDIAN_DEPTH of shared/axes.h: what its blend met in
  /// each pixel, one image of one channel a view; below 0 where there is nothing to tell. Walks the frame's
  /// lists again. Throws Error after a frame whose blend something else stood in for: its lists never get to
  /// the GPU.
  std::vector<Image> read_debug_view(int what);

  const std::shared_ptr<GpuModel>& model() const { return model_; }
  /// The pictures on the GPU: vec4 (C, T) by pixel, a view's from its pixel_offset on. Not where something
  /// else stood in for blend, whose pictures never get there, nor those of a frame on canvases.
  const gl::Buffer& colours() const { return buffers_.pictures.colours; }
  /// Their Z by pixel, likewise; of a frame on canvases depths (draw). Nothing with Depth::none.
  const gl::Buffer& z_sums() const { return buffers_.pictures.z_sums; }
  /// The views of the last frame drawn, with tiles, offsets and groups; a probe's comes last.
  const std::vector<shared::View>& views() const { return plan_.views; }
  const FramePlan& plan() const { return plan_; }
  FrameBuffers& buffers() { return buffers_; }
  /// Of the first model that is drawn, once a frame is.
  ModelBuffers& model_buffers() { return *model_buffers_.front(); }

 private:
  /// What was submitted, for attempts that follow.
  struct Submitted {
    std::vector<shared::View> views;
    FrameSettings settings;
    Workings workings;
    std::vector<Canvas> canvases;
    std::vector<MeshDepth> mesh_depths;
    int depth_rows = 1;
    Stage last = Stage::probe;
    bool searches = false;  // for the tolerance of its quality: each attempt has a probe
  };

  CallersTextures submitted_textures(bool with_canvases) const;
  void take(std::span<const shared::View> views, const FrameSettings& settings, const Workings& workings,
            const CallersTextures& textures);
  void note_begin();
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
  std::vector<Drawn> drawn_;                                  // each model once
  std::vector<InstancePlace> places_;                         // FramePlan::instances
  bool is_placed_anew_ = false;                               // other models than the last frame's
  std::vector<std::shared_ptr<ModelBuffers>> model_buffers_;  // of drawn_
  gl::Dispatcher dispatcher_;
  FrameBuffers buffers_;
  bool is_prepared_ = false;  // its programs were compiled, all at once
  Submitted submitted_;
  FramePlan plan_;
  Measuring measuring_;
  gl::Buffer counters_read_;     // Counters
  CpuTimes cpu_;                 // of the frame since it was submitted
  int programs_before_ = 0;      // Context::programs_made() at that time
  bool is_cut_ = false;          // FrameReport
  shared::Counters counters_{};  // of the last drawing
  double tiles_a_splat_ = 0.0;   // likewise
  Capacity capacity_;
  FrameHistory history_;
  ToleranceControl tolerance_control_;
  std::vector<Picture> pictures_stood_in_;  // where something else stood in for blend
};

}  // namespace binosplat::render
