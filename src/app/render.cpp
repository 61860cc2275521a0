// binosplat render: from options to pictures, in the order in which mistakes are cheapest to find.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <limits>
#include <memory>

#include "app/calibrated.h"
#include "app/command.h"
#include "app/detail.h"
#include "app/drawing.h"
#include "app/followed.h"
#include "app/open_scene.h"
#include "app/photos.h"
#include "app/render_options.h"
#include "app/render_outputs.h"
#include "app/render_report.h"
#include "app/shots.h"
#include "app/tour.h"
#include "base/choices.h"
#include "base/log.h"
#include "base/progress.h"
#include "formats/cameras_file.h"
#include "measure/depth_table.h"
#include "measure/metrics.h"
#include "render/frame.h"
#include "scene/axes.h"
#include "scene/framing.h"
#include "scene/scaffold.h"

namespace binosplat::app {

namespace fs = std::filesystem;

namespace {

void check_photos(const std::string& folder, const std::vector<Shot>& shots) {
  for (const Shot& shot : shots) {
    if (find_view_photo(folder, shot)) return;
  }
  fail("--photos {}: there is no photo of any view drawn, for one {}.jpg", folder, shots[0].stem);
}

// PSNR of the picture as 8 bits would keep it against the photo.
std::optional<double> photo_psnr(const RenderOptions& options, const Shot& shot, const Picture& picture) {
  if (options.photos.empty()) return std::nullopt;
  const auto file = find_view_photo(options.photos, shot);
  if (!file) {
    log_info("no photo of {} in {}", shot.name, options.photos);
    return std::nullopt;
  }
  const Image photo = load_view_photo(*file, shot.eyes.front().camera);
  const Image drawn = composite(picture, options.background.value_or(glm::vec3(0.0f)));
  return measure::psnr(quantised(drawn), quantised(photo));
}

// What the model takes on the GPU, and the shot that takes most.
render::MemoryNeeds memory_needs(const RenderOptions& options, const Model& model,
                                 const std::vector<Shot>& shots) {
  render::FrameSettings settings = settings_of(options);
  settings.depth_table = {1.0f, {1.0f}};  // not measured yet
  render::MemoryNeeds most;
  for (const Shot& shot : shots) {
    const auto needs = render::memory_needs(render::make_shape(views_of(shot), settings, model));
    most = {needs.model, std::max(most.frame, needs.frame)};
  }
  return most;
}

// What --transmittance depth goes by: the cameras of the list, evenly chosen, as the shots see the scene.
render::DepthTable depth_table(render::Frame& frame, const RenderOptions& options, const CameraList& list,
                               double near_plane, const std::string& axes) {
  constexpr std::size_t views_max = 16;
  const std::size_t count = std::min(views_max, list.cameras.size());
  std::vector<shared::View> views;
  for (std::size_t k = 0; k < count; ++k)
    views.push_back(make_view(into_axes(sized(options, list.cameras[k * list.cameras.size() / count]), axes),
                              near_plane));
  log_info("--transmittance depth: measuring {} view{} of {}", count, count == 1 ? "" : "s", list.source);
  return measure::measure_depth_table(frame, views);
}

// Draws every shot options.frames times and writes its last frame.
void draw_all(gl::Context& context, const OutputPlan& plan, std::vector<Shot> shots, const CameraList& list,
              Model& model, std::optional<FollowedLevels>& followed, RenderReport& report) {
  const RenderOptions& options = report.options;
  render::FrameSettings settings = settings_of(options);
  const render::Workings workings = workings_of(options);
  if (!along_path(options)) settings.probe_tiles = std::numeric_limits<int>::max();  // single pictures: all
  const auto gpu_model = std::make_shared<render::GpuModel>(context, report.model, settings.precision);
  render::Frame frame(gpu_model);
  stereo::Show show(gpu_model);
  const CalibratedSettings calibrated(options, report.model);
  if (settings.transmittance == TRANSMITTANCE_DEPTH && options.calibration.empty())
    settings.depth_table = depth_table(frame, options, list, report.near_plane, report.model.axes);
  const std::unique_ptr<Video> video = open_video(options, plan, shots);
  Progress progress("drawing", shots.size() * static_cast<std::size_t>(options.frames));
  std::size_t done = 0;
  for (Shot& shot : shots) {
    Drawn& drawn = report.drawn.emplace_back();
    drawn.shot = std::move(shot);
    const std::vector<shared::View> views = views_of(drawn.shot);
    const render::FrameSettings of_shot = calibrated.of(drawn.shot, settings);
    if (followed) drawn.levels = followed->follow(model, frame, show, views, of_shot);
    for (int n = 0; n < options.frames; ++n) {
      drawn.report = frame.draw(views, of_shot, workings);
      report.times.add(drawn.report);
      progress.update(++done);
    }
    const std::vector<Picture> pictures = frame.read_pictures();
    if (options.detail_report)
      drawn.levels->finest_psnr = followed->against_finest(context, views, pictures, of_shot);
    drawn.comfort = comfort_of(options, drawn.shot, pictures[0]);
    const stereo::Shown shown = show.make(find_choice("--show", options.show, show_choices), frame, views,
                                          pictures, of_shot, options.background);
    drawn.most_shown = shown.most;
    if (video) video->add(frame_of(options, plan, shown.pictures));
    drawn.files = video ? std::vector{plan.video.string()} : write_outputs(options, plan, drawn.shot, shown);
    drawn.photo_psnr = photo_psnr(options, drawn.shot, pictures[0]);
  }
  if (video) video->finish();
}

void log_model(const RenderOptions& options, const Model& model) {
  if (model.scaffold) {
    log_info("{}: {}", options.scene, describe(*model.scaffold));
  } else if (!options.decode.empty()) {
    fail("--decode {}: {} is no Scaffold-GS model, whose Gaussians are made for each eye", options.decode,
         options.scene);
  } else {
    log_info("{}: {} Gaussians, harmonics of degree {}", options.scene, model.count(), model.degree);
  }
}

// The folder of photos that --photos names, or the one found beside the cameras.
std::string photos_folder(const RenderOptions& options, const CameraList& list) {
  if (options.photos != photos_beside) return options.photos;
  const auto found = list.listed ? find_photos(list.source) : std::nullopt;
  if (!found)
    fail("--photos {}: there is no folder of photos beside the cameras of {}", photos_beside, list.source);
  return found->string();
}

ExitCode render(RenderOptions options) {
  check(options);
  const OutputPlan plan = plan_outputs(options);
  const Scene scene = open_scene(options);
  options.saved = find_saved(options);
  const auto saved = saved_camera(options);
  if (saved) log_info("drawing from the pose saved there (--view or --cameras for others)");
  CameraList list = saved ? *saved : listed_cameras(options, scene.cameras);
  if (options.tour) go_on_tour(options, !plan.video.empty(), list);
  options.photos = photos_folder(options, list);
  std::unique_ptr<gl::Context> context;  // outlives what draws with it
  std::optional<FollowedLevels> followed;
  if (options.detail) {
    followed.emplace(options);
  } else if (options.gpu_memory) {
    options.budget = detail_budget(options, list);
  }
  Model model = followed ? followed->coarsest() : scene.model();
  log_model(options, model);
  if (!list.listed) list = made_up_cameras(options, model);

  const double near_plane = near_plane_of(options, list, model);
  std::vector<Shot> shots = make_shots(options, list, near_plane, model.axes);
  check_shots(plan, shots);
  if (!options.photos.empty()) check_photos(options.photos, shots);
  if (followed) followed->bring(model, views_of(shots[0]));

  context = open_context(options);
  if (!options.shader_dir.empty()) context->set_shader_folder(options.shader_dir);
  RenderReport report{options, model, *context, near_plane, memory_needs(options, model, shots), {}, {}};
  print_needs(report.needs);
  draw_all(*context, plan, std::move(shots), list, model, followed, report);
  print(report);
  if (!options.json.empty()) save(options.json, report);
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
      "  binosplat render garden.ply --tour 0.5,30 --seconds 2 --preset headset --quality 40 -o frames");
  sub->callback([options, &command] { command = [options] { return render(*options); }; });
}

}  // namespace binosplat::app
