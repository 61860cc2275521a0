// binosplat render: from options to pictures, in the order in which mistakes are cheapest to find.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/calibrated.h"
#include "app/command.h"
#include "app/command_line.h"
#include "app/demo_eyes.h"
#include "app/detail.h"
#include "app/empty_view.h"
#include "app/followed.h"
#include "app/foveate_options.h"
#include "app/load_scene.h"
#include "app/photos.h"
#include "app/render_options.h"
#include "app/render_outputs.h"
#include "app/render_report.h"
#include "app/resume.h"
#include "app/shots.h"
#include "app/tour.h"
#include "app/vr180.h"
#include "base/log.h"
#include "base/progress.h"
#include "formats/cameras_file.h"
#include "measure/depth_table.h"
#include "measure/metrics.h"
#include "render/frame.h"
#include "scene/axes.h"
#include "scene/framing.h"
#include "scene/scaffold.h"
#include "stereo/comfort.h"

namespace binosplat::app {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

namespace {

void check_any_photo(const std::string& folder, const std::vector<Camera>& cameras) {
  for (const Camera& camera : cameras) {
    if (find_view_photo(folder, camera.name)) return;
  }
  fail("--photos {}: there is no photo of any view drawn, for one {}.jpg", folder, stem_of(cameras[0].name));
}

// PSNR of the picture as 8 bits would keep it against the photo, where there is a folder of them.
std::optional<double> photo_psnr(const std::string& folder, const glm::vec3& background, const Shot& shot,
                                 const Picture& picture) {
  if (folder.empty()) return std::nullopt;
  const auto file = find_view_photo(folder, shot.name);
  if (!file) {
    log_info("no photo of {} in {}", shot.name, folder);
    return std::nullopt;
  }
  const Image photo = load_view_photo(*file, shot.eyes.front().camera, background);
  return measure::psnr(quantised(composite(picture, background)), photo);
}

// What the model takes on the GPU, and the shot that takes most.
render::MemoryNeeds memory_needs(render::FrameSettings settings, const Model& model,
                                 const std::vector<Shot>& shots, std::optional<double> vr180_near,
                                 const std::optional<stereo::Foveation>& foveate) {
  settings.depth_table = {1.0f, {1.0f}};  // not measured yet
  render::MemoryNeeds most;
  for (const Shot& shot : shots) {
    const auto needs = vr180_near ? vr180_memory(shot, model, *vr180_near)
                       : foveate  ? foveated_memory(views_of(shot), *foveate, settings, model)
                                  : render::memory_needs(render::make_plan(views_of(shot), settings, model));
    most = {needs.model, std::max(most.frame, needs.frame)};
  }
  return most;
}

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

std::optional<double> finite(const std::optional<double>& metres) {
  return metres && std::isfinite(*metres) ? metres : std::nullopt;
}

bool is_empty(const Picture& picture) {
  return std::all_of(picture.colour.begin(), picture.colour.end(),
                     [](const glm::vec4& c) { return c.a == 1.0f; });
}

// Whether pictures are for a screen whose distance no option says: both eyes in one, and not for a headset.
bool seeks_screen(const RenderOptions& o, const OutputPlan& plan) {
  const bool flat = plan.layout != LAYOUT_SEPARATE && plan.layout != LAYOUT_MULTI_VIEW;
  return flat && !plan.vr180 && !o.rig.convergence && o.rig.cant.value_or(0.0) == 0.0 &&
         !o.camera.lens.headset();
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

// What is drawn, and by what.
struct Work {
  OutputPlan plan;
  CalibratedSettings calibrated;
  CameraList list;
  std::vector<Shot> shots;
  std::optional<Shot> screen;  // what tells how far the screen is, where no option does
  std::string photos;          // a folder; empty: none
  bool heads_turn = false;
  std::unique_ptr<Stream> stream;  // of a model whose levels follow the shots
};

// Of those that are drawn, before the model is read; and that each has a photo of its own.
void check_photos_drawn(const RenderOptions& o, const Work& work) {
  if (work.photos.empty() || !work.list.listed) return;
  check_photos_apart(work.photos, work.list.cameras);
  std::vector<Camera> cameras = chosen_cameras(o.camera.views, o.camera.lens, work.list);
  if (o.camera.views.empty() && !work.list.path) cameras.resize(1);
  check_any_photo(work.photos, cameras);
  check_photos(work.photos, cameras);
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

// Draws every shot as often as asked for and writes its last frame.
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
  const std::unique_ptr<Video> video = open_video(work.plan, work.shots);
  std::optional<FinestLevels> finest;
  std::optional<glm::vec3> of_switches;  // the background, where they are reported
  if (output.detail_report && work.heads_turn) of_switches = settings.background;
  bool all_empty = true;
  Progress progress("drawing", work.shots.size() * static_cast<std::size_t>(drawing.frames));
  std::size_t done = 0;
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
      drawn.report = panorama   ? draw(*panorama, drawn.shot, report.model.axes, report.near_plane)
                     : foveated ? foveated->draw(views, *foveate, of_shot, workings)
                                : frame.draw(views, of_shot, workings);
      report.times.add(drawn.report);
      progress.update(++done);
    }
    const std::vector<Picture> pictures = panorama   ? panorama->read_pictures()
                                          : foveated ? foveated->read_pictures()
                                                     : frame.read_pictures();
    if (foveated) drawn.foveated = foveated->parts();
    all_empty = all_empty && std::all_of(pictures.begin(), pictures.end(), is_empty);
    if (output.detail_report) {
      if (!finest) finest.emplace(report.options.scene, context);
      drawn.levels->finest_psnr = finest->psnr(views, pictures, of_shot, settings.background);
    }
    if (!panorama) drawn.comfort = comfort_of(drawn.shot, report.options.camera.lens.headset(), pictures[0]);
    const stereo::DebugPictures shown =
        show.make(output.show, {frame, views, pictures, of_shot}, output.background);
    drawn.most_shown = shown.most;
    if (video) video->add(frame_of(work.plan, output.background, shown.pictures));
    drawn.files = video ? std::vector{work.plan.video.string()}
                        : write_outputs(report.options.scene.name, output, work.plan, drawn.shot, shown);
    drawn.photo_psnr = photo_psnr(work.photos, output.backdrop(), drawn.shot, pictures[0]);
  }
  if (video) video->finish();
  report.exact_ms = exact_frame_ms(frame, work, report);
  if (all_empty && !drawing.reference_until && !report.drawn.empty())
    log_warning("the pictures are empty: {}",
                why_empty(report.model, report.drawn[0].shot, report.near_plane));
}

void log_model(const std::string& scene, const std::optional<int>& decode, const Model& model,
               std::size_t gaussians) {
  if (model.scaffold) {
    log_info("{}: {}", scene, describe(*model.scaffold));
  } else if (decode) {
    fail("--decode {}: {} is no Scaffold-GS model, whose Gaussians are made for each eye",
         decode_choices[*decode].name, scene);
  } else {
    log_info("{}: {} Gaussians, harmonics of degree {}", scene, gaussians, model.degree);
  }
}

// The folder of photos that --photos names, or the one found beside the cameras.
std::string photos_folder(const std::string& asked, const CameraList& list) {
  if (asked != photos_beside) return asked;
  const auto found = list.listed ? find_photos(list.source) : std::nullopt;
  if (!found)
    fail("--photos {}: there is no folder of photos beside the cameras of {}", photos_beside, list.source);
  return found->string();
}

// Those that options or a saved pose choose; none where they are to be made up.
CameraList find_list(const RenderOptions& o, const OutputPlan& plan) {
  const auto saved = find_saved(o.scene);
  // Photos are of the cameras that the model was trained on.
  if (const auto pose = o.output.photos.empty() ? saved_camera(o.scene, o.camera, saved) : std::nullopt) {
    log_info("drawing from the pose saved there (--view or --cameras for others)");
    return *pose;
  }
  CameraList list = listed_cameras(o.scene, o.camera, o.rig, saved);
  if (o.camera.tour) return go_on_tour(o.scene, o.camera, o.rig, *plan.fps, std::move(list));
  if (!o.camera.path.empty()) return go_along_path(o.camera, plan.fps, !plan.video.empty(), std::move(list));
  return list;
}

// Leaves the shots that this run is to draw. What tells it from others, with --resume.
std::optional<ordered_json> take_what_is_left(const RenderOptions& o, double near_plane, Work& work) {
  std::optional<ordered_json> run;
  if (o.resume) run = identity_of(o, work.list, near_plane, work.shots);
  const std::size_t all = work.shots.size();
  take_share(o.shard, work.shots);
  if (!o.shard.all())
    log_info("--shard {}/{}: {} of {} views", o.shard.index + 1, o.shard.count, work.shots.size(), all);
  if (run) {
    leave_out_drawn(work.plan, *run, work.shots);
  } else {
    forget_run(work.plan);
  }
  return run;
}

ExitCode render(const RenderOptions& asked) {
  check(asked);
  const RenderOptions o = with_eyes_of_demo(asked);
  std::unique_ptr<gl::Context> context;  // outlives what draws with it
  Work work{.plan = plan_outputs(o), .calibrated = CalibratedSettings(o.drawing)};
  work.list = find_list(o, work.plan);
  check_views(o.camera.views, o.rig.mono, work.list);
  work.photos = photos_folder(o.output.photos, work.list);
  note_photos(work.photos);
  check_photos_drawn(o, work);
  const render::FrameSettings settings = settings_of(o.drawing);
  std::optional<DetailBudget> budget;
  if (o.scene.detail || may_share(o)) {
    work.heads_turn = work.list.path || work.plan.vr180;  // such a picture shows what lies beside the view
    work.stream = open_for_shots(o.scene, settings, work.heads_turn);
    if (!o.scene.detail && !work.stream->files().has_errors()) work.stream.reset();
  }
  if (!work.stream && o.output.detail_report)
    fail("--detail-report: {} does not say what its levels lose, to share --quality with: give --detail PX",
         o.scene.name);
  if (!work.stream && o.scene.gpu_memory) budget = detail_budget(o, work.list);
  Model loaded;
  if (!work.stream) loaded = load_scene(o.scene, budget, work.list.cameras);
  const Model& model = work.stream ? work.stream->model() : loaded;
  log_model(o.scene.name, o.drawing.decode, model, work.stream ? work.stream->gaussians() : model.count());
  if (!work.list.listed) work.list = made_up_cameras(o.scene, o.camera, work.list.known, model);

  const double near_plane = near_plane_of(o.camera, work.list);
  work.shots = make_shots(o.camera.views, o.camera.lens, o.rig, work.list, near_plane, model.axes);
  if (work.plan.vr180) {
    for (Shot& shot : work.shots) level(shot, up_of(o.camera, work.list.known));
  }
  check_shots(work.plan, work.shots, o.output.json);
  if (!work.photos.empty() && !work.list.listed) check_any_photo(work.photos, work.list.cameras);
  if (seeks_screen(o, work.plan)) {
    const auto head =
        std::find_if(work.shots.begin(), work.shots.end(), [](const Shot& shot) { return !shot.given_eyes; });
    if (head != work.shots.end()) work.screen = *head;
  }
  const std::vector<shared::View> first =
      views_of(work.shots[0]);  // whichever part of the views is drawn here
  const std::optional<ordered_json> run = take_what_is_left(o, near_plane, work);
  if (work.shots.empty()) return ExitCode::done;
  context = open_context(o.context);
  if (work.stream) {
    work.stream->gpu_model(*context, settings.precision);
    work.stream->settle(first, settings);
  }
  const auto vr180_near = work.plan.vr180 ? std::optional(near_plane) : std::nullopt;
  RenderReport report{o,
                      model,
                      *context,
                      near_plane,
                      memory_needs(settings, model, work.shots, vr180_near, o.foveate),
                      finite(o.rig.convergence),
                      {},
                      {}};
  print_needs(report.needs);
  if (o.output.output.empty()) claim_folder(work.plan.folder, o.scene.name);
  draw_all(*context, work, report);
  check_alone(work.plan, run);
  print(report);
  if (!o.output.json.empty()) save(o.output.json, report);
  return ExitCode::done;
}

}  // namespace

void add_render(CLI::App& program, Command& command) {
  CLI::App* sub = program.add_subcommand("render", "Draw both eyes of a model");
  const auto options = std::make_shared<RenderOptions>();
  add_options(*sub, *options);
  sub->footer(
      "Examples:\n"
      "  binosplat render demo:room -o out/demo\n"
      "  binosplat render demo:city --count 4250000 --view all\n"
      "  binosplat render garden.ply --view DSC07956 -o pair.png\n"
      "  binosplat render garden.ply --convergence 3 --layout anaglyph -o red-cyan.png\n"
      "  binosplat render garden.ply --view all --mono --photos images -o out\n"
      "  binosplat render scan.ply --eye 0,-1.6,3 --at 0,-1,0 --convergence 2\n"
      "  binosplat render scaffold-model --decode cyclopean\n"
      "  binosplat render scan.ply --orbit 24 --preset headset --exr half\n"
      "  binosplat render scan.ply --orbit 120 --layout half-width -o around.mp4\n"
      "  binosplat render garden.ply --tour walk --mono -o walk.mp4\n"
      "  binosplat render garden.ply --path out/garden/cameras.json --seconds 10 -o keys.mp4\n"
      "  binosplat render garden.ply --view all --shard $I/8 --resume -o out     # on 8 machines\n"
      "  binosplat render garden.ply --tour 0.5,30 --seconds 2 --preset headset --quality 40 -o frames");
  sub->callback([options, sub, &command] {
    options->given = options_given(*sub);
    command = [options] { return render(*options); };
  });
}

}  // namespace binosplat::app
