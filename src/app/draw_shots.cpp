#include "app/draw_shots.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "app/empty_view.h"
#include "app/followed.h"
#include "app/foveate_options.h"
#include "app/sequence.h"
#include "app/shot_files.h"
#include "app/vr180.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/progress.h"
#include "measure/depth_table.h"
#include "render/frame.h"
#include "render/read_back.h"
#include "scene/axes.h"
#include "stereo/comfort.h"

namespace binosplat::app {

namespace {

// What --transmittance depth goes by: the cameras of the list, evenly chosen, as the shots see the scene.
render::DepthTable depth_table(render::Frame& frame, const Lens& lens, const CameraList& list,
                               double near_plane, const ModelAxes& axes,
                               const render::FrameSettings& settings) {
  constexpr std::size_t views_max = 16;
  const std::size_t count = std::min(views_max, list.cameras.size());
  std::vector<shared::View> views;
  for (std::size_t k = 0; k < count; ++k)
    views.push_back(
        make_view(into_axes(sized(lens, list.cameras[k * list.cameras.size() / count]), axes), near_plane));
  log_info("--transmittance depth: measuring {} view{} of {}", count, count == 1 ? "" : "s", list.source);
  return measure::measure_depth_table(frame, views,
                                      {.order = settings.order, .projection = settings.projection});
}

// How far the screen is, in metres, where no option says it: what suits the first view of the run, whichever
// part of it is drawn here; nothing where that shows nothing.
std::optional<double> find_screen(render::Frame& frame, const render::FrameSettings& settings,
                                  const Shot& first) {
  frame.draw(std::array{first.eyes[0].view},
             {.order = settings.order, .projection = settings.projection, .precision = settings.precision});
  const auto metres = stereo::suitable_convergence({first.eyes[0].camera, first.eyes[1].camera},
                                                   frame.read_pictures()[0], first.units_per_metre);
  frame.start_over();
  if (metres)
    log_info("convergence {:.3g} m, which suits what {} shows (--convergence METRES for another, or inf)",
             *metres, first.name);
  return metres;
}

// What an exact frame takes in the place of the last of a long path, to say whether --quality paid; nothing
// where a path is too short to tell, or its frames are not drawn whole.
std::optional<double> exact_frame_ms(render::Frame& frame, const Work& work, const RenderReport& report) {
  // Frames, of which these two are a small share, or by a CPU, where it hardly ever pays, the one.
  constexpr std::size_t many = 24, some = 6;
  const RenderOptions& o = report.options;
  if (!o.drawing.quality || !work.list.path ||
      report.drawn.size() < (report.context.software() ? some : many) || work.stream || o.foveate ||
      work.plan.vr180 || !report.drawn[0].shot.model.empty())
    return std::nullopt;
  render::FrameSettings exact = render::exact_of(settings_of(o.drawing));
  exact.precision = o.drawing.precision;
  const std::vector<shared::View> views = views_of(report.drawn.back().shot);
  if (report.drawn.size() >= many) frame.draw(views, exact);  // in which drivers compile their programs
  return frame.draw(views, exact).total_ms;
}

/// What draws shots: the frame, or what the options want in its place.
struct Drawer {
  Drawer(gl::Context& of, const RenderReport& report, const std::optional<int>& panorama_width,
         const std::shared_ptr<render::GpuModel>& model)
      : context(of), options(report.options), frame(model), show(model) {
    if (panorama_width) panorama.emplace(model, *panorama_width);
    if (options.foveate) foveated.emplace(model);
  }

  gl::Context& context;
  const RenderOptions& options;
  render::Frame frame;
  stereo::DebugView show;
  std::optional<stereo::Panorama> panorama;
  std::optional<stereo::FoveatedFrame> foveated;
  std::optional<FinestLevels> finest;

  /// Whether the frame's own pictures are all that is wanted, which are read while the next ones are drawn.
  bool reads_behind() const {
    return !panorama && !foveated && options.output.show == SHOW_PICTURE && !options.output.detail_report;
  }

  /// The pictures of a shot that was drawn, where they are read at once.
  ShotPictures read(Drawn& drawn, const std::vector<shared::View>& views,
                    const render::FrameSettings& settings) {
    ShotPictures of{panorama   ? panorama->read_pictures()
                    : foveated ? foveated->read_pictures()
                               : frame.read_pictures(),
                    {}};
    const OutputOptions& output = options.output;
    if (output.detail_report) {
      if (!finest) finest.emplace(options.scene, context);
      drawn.levels->finest_psnr = finest->psnr(views, of.pictures, settings, settings.background);
    }
    if (output.show != SHOW_PICTURE) {
      of.shown = show.make(output.show, {frame, views, of.pictures, settings}, output.background);
      drawn.most_shown = of.shown->most;
    }
    return of;
  }
};

/// Shots on their way from the GPU to files, and what that takes of the time of the thread that draws.
class ShotPipeline {
 public:
  ShotPipeline(gl::Context& context, const Work& work, const RenderReport& report)
      : read_back_(context), files_(report.options, work.plan, work.photos, work.shots) {}

  /// Asks for the pictures that the frame has of a shot.
  void read(Drawn& drawn, const render::Frame& frame) {
    pictures_ = read_back_.start(frame);
    of_ = &drawn;
  }

  /// Hands over what was asked for, if anything was, once the GPU has copied it.
  void hand_over() {
    if (!pictures_) return;
    const auto begin = Clock::now();
    pictures_->wait();
    times_.reading += ms_since(begin);
    add(*of_, [taken = std::exchange(pictures_, nullptr)] { return ShotPictures{taken->take(), {}}; });
  }

  /// Takes the pictures of a shot that was drawn: while the next one is, or at once.
  void take(Drawer& drawer, Drawn& drawn, const std::vector<shared::View>& views,
            const render::FrameSettings& settings) {
    if (drawer.reads_behind()) return read(drawn, drawer.frame);
    const auto pictures = std::make_shared<ShotPictures>(drawer.read(drawn, views, settings));
    add(drawn, [pictures] { return std::move(*pictures); });
  }

  void add(Drawn& drawn, std::function<ShotPictures()> take) {
    const auto begin = Clock::now();
    files_.add(drawn, std::move(take));
    times_.waiting += ms_since(begin);
  }

  /// Waits until all files are there.
  RunTimes finish() {
    hand_over();
    const auto begin = Clock::now();
    files_.finish();
    times_.waiting += ms_since(begin);
    times_.all = ms_since(start_);
    times_.encoding = files_.encoding_seconds();
    times_.writing = files_.writing_seconds();
    times_.threads = files_.threads();
    times_.is_video = files_.is_video();
    return times_;
  }

  bool all_empty() const { return files_.all_empty(); }

 private:
  render::ReadBack read_back_;
  ShotFiles files_;
  std::shared_ptr<render::ReadBack::Pictures> pictures_;  // after those two, so that it goes first
  Drawn* of_ = nullptr;
  RunTimes times_;
  Clock::time_point start_ = Clock::now();
};

}  // namespace

void draw_all(gl::Context& context, Work& work, RenderReport& report) {
  const DrawingOptions& drawing = report.options.drawing;
  const OutputOptions& output = report.options.output;
  render::FrameSettings settings = settings_of(drawing);
  settings.background = output.backdrop();
  const render::Workings workings = workings_of(drawing);
  if (!work.list.path) settings.probe_tiles = std::numeric_limits<int>::max();  // single pictures: all
  auto gpu_model = work.stream
                       ? work.stream->gpu_model(context, settings.precision)
                       : std::make_shared<render::GpuModel>(context, report.model, settings.precision);
  std::optional<Model> shown;  // of a sequence, where it is not the report's
  std::optional<int> panorama_width;
  if (work.plan.vr180) panorama_width = work.shots[0].eyes[0].camera.width;
  std::optional<Drawer> drawer(std::in_place, context, report, panorama_width, std::move(gpu_model));
  work.calibrated.check_model(report.model, settings);
  if (settings.transmittance == TRANSMITTANCE_DEPTH && drawing.calibration.empty())
    settings.depth_table = depth_table(drawer->frame, report.options.camera.lens, work.list,
                                       report.near_plane, report.model.axes, settings);
  if (work.screen) report.convergence = find_screen(drawer->frame, settings, *work.screen);
  if (work.screen && report.convergence) {
    for (Shot& shot : work.shots) converge(shot, *report.convergence);
  }
  std::optional<glm::vec3> of_switches;  // the background, where they are reported
  if (output.detail_report && work.heads_turn) of_switches = settings.background;

  std::optional<ModelsInTurn> in_turn;
  if (!work.shots[0].model.empty()) in_turn.emplace(report.options.scene, report.model, work.shots);

  ShotPipeline pipeline(context, work, report);
  Progress progress("drawing", work.shots.size() * static_cast<std::size_t>(drawing.frames),
                    drawing.frames == 1 ? "views" : "frames");
  std::size_t done = 0;
  double gpu_ms = 0.0;
  report.drawn.reserve(work.shots.size());  // the pipeline refers to them
  for (Shot& shot : work.shots) {
    if (in_turn && !report.drawn.empty()) {
      pipeline.hand_over();
      drawer.reset();
      shown = in_turn->take();
      drawer.emplace(context, report, panorama_width,
                     std::make_shared<render::GpuModel>(context, *shown, settings.precision));
    }
    render::Frame& frame = drawer->frame;
    // Single pictures do not depend on which were drawn before them.
    if (!work.list.path) (drawer->foveated ? drawer->foveated->frame() : frame).start_over();
    Drawn& drawn = report.drawn.emplace_back();
    drawn.shot = std::move(shot);
    const std::vector<shared::View> views = views_of(drawn.shot);
    render::FrameSettings of_shot = work.calibrated.of(drawn.shot, settings);
    of_shot.depth = output.exr_depth;
    if (work.stream) {
      drawn.levels = settle_shot(*work.stream, frame, drawer->show, views, of_shot, of_switches);
      of_shot.quality = static_cast<float>(drawn.levels->left);
    }
    for (int n = 0; n < drawing.frames; ++n) {
      if (drawer->panorama) {
        drawn.report = draw(*drawer->panorama, drawn.shot, report.model.axes, report.near_plane);
      } else if (drawer->foveated) {
        drawn.report = drawer->foveated->draw(views, *report.options.foveate, of_shot, workings);
      } else {
        frame.submit(views, of_shot, workings);
        pipeline.hand_over();
        drawn.report = frame.finish();
      }
      report.times.add(drawn.report);
      gpu_ms += drawn.report.total_ms;
      progress.update(++done);
    }
    if (drawer->foveated) drawn.foveated = drawer->foveated->parts();
    pipeline.take(*drawer, drawn, views, of_shot);
  }
  report.run = pipeline.finish();
  report.run.gpu = gpu_ms;
  report.exact_ms = exact_frame_ms(drawer->frame, work, report);
  if (pipeline.all_empty() && !drawing.reference_until && !report.drawn.empty())
    log_warning("the pictures are empty: {}",
                why_empty(report.model, report.drawn[0].shot, report.near_plane));
}

}  // namespace binosplat::app
