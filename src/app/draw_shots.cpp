#include "app/draw_shots.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "app/empty_view.h"
#include "app/followed.h"
#include "app/foveate_options.h"
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
                               double near_plane, const std::string& axes,
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

// That distance, in metres: what suits the first view of the run, whichever part of it is drawn here; nothing
// where that shows nothing.
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
      work.plan.vr180)
    return std::nullopt;
  render::FrameSettings exact = render::exact_of(settings_of(o.drawing));
  exact.precision = o.drawing.precision;
  const std::vector<shared::View> views = views_of(report.drawn.back().shot);
  if (report.drawn.size() >= many) frame.draw(views, exact);  // in which drivers compile their programs
  return frame.draw(views, exact).total_ms;
}

}  // namespace

void draw_all(gl::Context& context, Work& work, RenderReport& report) {
  const DrawingOptions& drawing = report.options.drawing;
  const OutputOptions& output = report.options.output;
  render::FrameSettings settings = settings_of(drawing);
  settings.background = output.backdrop();
  const render::Workings workings = workings_of(drawing);
  if (!work.list.path) settings.probe_tiles = std::numeric_limits<int>::max();  // single pictures: all
  const auto gpu_model = work.stream
                             ? work.stream->gpu_model(context, settings.precision)
                             : std::make_shared<render::GpuModel>(context, report.model, settings.precision);
  render::Frame frame(gpu_model);
  stereo::DebugView show(gpu_model);
  work.calibrated.check_model(report.model);
  if (settings.transmittance == TRANSMITTANCE_DEPTH && drawing.calibration.empty())
    settings.depth_table = depth_table(frame, report.options.camera.lens, work.list, report.near_plane,
                                       report.model.axes, settings);
  std::optional<stereo::Panorama> panorama;
  if (work.plan.vr180) panorama.emplace(gpu_model, work.shots[0].eyes[0].camera.width);
  const std::optional<stereo::Foveation>& foveate = report.options.foveate;
  std::optional<stereo::FoveatedFrame> foveated;
  if (foveate) foveated.emplace(gpu_model);
  if (work.screen) report.convergence = find_screen(frame, settings, *work.screen);
  if (work.screen && report.convergence) {
    for (Shot& shot : work.shots) converge(shot, *report.convergence);
  }
  std::optional<FinestLevels> finest;
  std::optional<glm::vec3> of_switches;  // the background, where they are reported
  if (output.detail_report && work.heads_turn) of_switches = settings.background;

  render::ReadBack read_back(context);
  ShotFiles files(report.options, work.plan, work.photos, work.shots);
  std::shared_ptr<render::ReadBack::Pictures> pictures;  // of the shot before, on their way
  RunTimes times;
  const auto start = Clock::now();
  const auto add = [&](Drawn& drawn, std::function<ShotPictures()> take) {
    const auto begin = Clock::now();
    files.add(drawn, std::move(take));
    times.waiting += ms_since(begin);
  };
  const auto hand_over = [&](Drawn& drawn) {
    if (!pictures) return;
    const auto begin = Clock::now();
    pictures->wait();
    times.reading += ms_since(begin);
    add(drawn, [taken = std::exchange(pictures, nullptr)] { return ShotPictures{taken->take(), {}}; });
  };
  // Others than a frame's own pictures are read at once.
  const bool reads_ahead = !panorama && !foveated && output.show == SHOW_PICTURE && !output.detail_report;

  Progress progress("drawing", work.shots.size() * static_cast<std::size_t>(drawing.frames),
                    drawing.frames == 1 ? "views" : "frames");
  std::size_t done = 0;
  report.drawn.reserve(work.shots.size());  // files refers to them
  for (Shot& shot : work.shots) {
    // Single pictures do not depend on which were drawn before them.
    if (!work.list.path) (foveated ? foveated->frame() : frame).start_over();
    Drawn& drawn = report.drawn.emplace_back();
    drawn.shot = std::move(shot);
    const std::vector<shared::View> views = views_of(drawn.shot);
    render::FrameSettings of_shot = work.calibrated.of(drawn.shot, settings);
    of_shot.depth = output.exr_depth;
    if (work.stream) {
      drawn.levels = settle_shot(*work.stream, frame, show, views, of_shot, of_switches);
      of_shot.quality = static_cast<float>(drawn.levels->left);
    }
    for (int n = 0; n < drawing.frames; ++n) {
      if (panorama) {
        drawn.report = draw(*panorama, drawn.shot, report.model.axes, report.near_plane);
      } else if (foveated) {
        drawn.report = foveated->draw(views, *foveate, of_shot, workings);
      } else {
        frame.submit(views, of_shot, workings);
        if (report.drawn.size() > 1) hand_over(report.drawn[report.drawn.size() - 2]);
        drawn.report = frame.finish();
      }
      report.times.add(drawn.report);
      times.gpu += drawn.report.total_ms;
      progress.update(++done);
    }
    if (foveated) drawn.foveated = foveated->parts();
    if (reads_ahead) {
      pictures = read_back.start(frame);
      continue;
    }
    ShotPictures of{panorama   ? panorama->read_pictures()
                    : foveated ? foveated->read_pictures()
                               : frame.read_pictures(),
                    {}};
    if (output.detail_report) {
      if (!finest) finest.emplace(report.options.scene, context);
      drawn.levels->finest_psnr = finest->psnr(views, of.pictures, of_shot, settings.background);
    }
    if (output.show != SHOW_PICTURE) {
      of.shown = show.make(output.show, {frame, views, of.pictures, of_shot}, output.background);
      drawn.most_shown = of.shown->most;
    }
    add(drawn, [taken = std::make_shared<ShotPictures>(std::move(of))] { return std::move(*taken); });
  }
  if (!report.drawn.empty()) hand_over(report.drawn.back());
  const auto end = Clock::now();
  files.finish();
  times.waiting += ms_since(end);
  times.all = ms_since(start);
  times.encoding = files.encoding_seconds();
  times.writing = files.writing_seconds();
  times.threads = files.threads();
  report.run = times;
  report.exact_ms = exact_frame_ms(frame, work, report);
  if (files.all_empty() && !drawing.reference_until && !report.drawn.empty())
    log_warning("the pictures are empty: {}",
                why_empty(report.model, report.drawn[0].shot, report.near_plane));
}

}  // namespace binosplat::app
