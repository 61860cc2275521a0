// binosplat render: from options to pictures, in the order in which mistakes are cheapest to find.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <future>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/command.h"
#include "app/command_line.h"
#include "app/draw_shots.h"
#include "app/followed.h"
#include "app/foveate_options.h"
#include "app/load_scene.h"
#include "app/outputs.h"
#include "app/photos.h"
#include "app/render_options.h"
#include "app/render_table.h"
#include "app/resume.h"
#include "app/sequence.h"
#include "app/shots.h"
#include "app/together.h"
#include "app/tour.h"
#include "app/vr180.h"
#include "base/log.h"
#include "demo/demo.h"
#include "formats/cameras_file.h"
#include "scene/axes.h"
#include "scene/framing.h"
#include "scene/scaffold.h"

namespace binosplat::app {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

namespace {

void check_any_photo(const std::string& folder, const std::vector<Camera>& cameras) {
  for (const Camera& camera : cameras) {
    if (find_view_photo(folder, camera)) return;
  }
  fail("--photos {}: there is no photo of any view drawn, for one {}.jpg", folder, stem_of(cameras[0].name));
}

// What the model takes on the GPU, and the shot that takes most.
render::MemoryNeeds memory_needs(const RenderOptions& o, const Work& work, double near_plane,
                                 const Model& model) {
  render::FrameSettings settings = settings_of(o.drawing);
  settings.depth_table = {1.0f, {1.0f}};  // not measured yet
  render::MemoryNeeds most;
  for (const Shot& shot : work.shots) {
    const std::vector<shared::View> views = views_of(shot);
    const auto needs = work.outputs.vr180 ? vr180_memory(shot, model, near_plane)
                       : o.foveate        ? foveated_memory(views, *o.foveate, settings, model)
                                          : render::memory_needs(render::make_plan(views, settings, model));
    most = {needs.model, std::max(most.frame, needs.frame)};
  }
  return most;
}

std::optional<double> finite(const std::optional<double>& metres) {
  return metres && std::isfinite(*metres) ? metres : std::nullopt;
}

// The shot that tells how far the screen is, which no option says: where pictures are for one, with both eyes
// in one picture, and not for a headset.
std::optional<Shot> shot_for_screen(const RenderOptions& o, const Outputs& outputs,
                                    const std::vector<Shot>& shots) {
  const bool flat = outputs.layout != LAYOUT_SEPARATE && outputs.layout != LAYOUT_MULTI_VIEW;
  if (!flat || outputs.vr180 || o.rig.convergence || o.rig.cant.value_or(0.0) != 0.0 ||
      o.camera.lens.headset())
    return std::nullopt;
  const auto head = std::ranges::find_if(shots, [](const Shot& shot) { return !shot.given_eyes; });
  return head == shots.end() ? std::nullopt : std::optional(*head);
}

// Of those that are drawn, before the model is read; and that each has a photo of its own.
void check_photos_drawn(const RenderOptions& o, const Work& work) {
  if (work.photos.folder.empty() || !work.list.listed) return;
  check_photos_apart(work.photos.folder, work.list.cameras);
  std::vector<Camera> cameras = chosen_cameras(o.camera.views, o.camera.lens, work.list);
  if (o.camera.views.empty() && !work.list.path) cameras.resize(1);
  check_any_photo(work.photos.folder, cameras);
  check_photos(work.photos.folder, cameras);
}

void log_model(const std::string& scene, const std::optional<int>& decode, const Model& model,
               const StreamedModel* stream) {
  if (model.scaffold) {
    log_info("{}: {}", scene, describe(*model.scaffold));
  } else if (decode) {
    fail("--decode {}: {} is no Scaffold-GS model, whose Gaussians are made for each eye",
         decode_choices[*decode].name, scene);
  } else {
    log_info("{}: {} Gaussians{}, harmonics of degree {}", scene,
             stream != nullptr ? stream->gaussians() : model.count(), stream != nullptr ? " at first" : "",
             model.degree);
  }
}

// Those that options or a saved pose choose; none where they are to be made up.
CameraList find_list(const RenderOptions& o, const Outputs& outputs) {
  const auto saved = find_saved(o.scene);
  // Photos are of the cameras that the model was trained on.
  if (const auto pose = o.output.photos.empty() ? saved_camera(o.scene, o.camera, saved) : std::nullopt) {
    log_info("drawing from the pose saved there (--view or --cameras for others)");
    return *pose;
  }
  CameraList list = listed_cameras(o.scene, o.camera, o.rig, saved);
  if (o.camera.tour) return go_on_tour(o.scene, o.camera, o.rig, *outputs.fps, std::move(list));
  if (!o.camera.path.empty()) return go_along_path(o.camera, outputs.fps, outputs.video, std::move(list));
  return list;
}

// What the cameras become: the views that are drawn, and the files of each.
std::vector<Shot> plan_shots(const RenderOptions& o, const Work& work, const std::vector<fs::path>& sequence,
                             double near_plane, const ModelAxes& axes) {
  std::vector<Shot> shots = make_shots(o.camera.views, o.camera.lens, o.rig, work.list, near_plane, axes);
  if (work.outputs.vr180) {
    for (Shot& shot : shots) level(shot, up_of(o.camera, work.list.known));
  }
  if (!sequence.empty()) show_in_turn(sequence, shots);
  place_files(work.outputs, o.output.json, shots);
  return shots;
}

// Leaves the shots that this run is to draw. What tells it from others, with --resume.
std::optional<ordered_json> take_what_is_left(const RenderOptions& o, double near_plane, Work& work) {
  const fs::path& folder = work.outputs.folder;
  const std::size_t all = work.shots.size();
  std::optional<ordered_json> run;
  if (o.resume) run = identity_of(o, work.list, near_plane, work.shots);
  take_share(o.shard, work.shots);
  if (!o.shard.all())
    log_info("--shard {}/{}: {} of {} views", o.shard.index + 1, o.shard.count, work.shots.size(), all);
  if (run) {
    leave_out_drawn(folder, *run, work.shots);
  } else {
    forget_run(folder);
  }
  return run;
}

// A built-in scene's own views are drawn, where no option says anything of eyes, screen, lens or way, with a
// pair of eyes and a screen that make all of them comfortable (stereo/comfort.h). A head's eyes with the
// screen infinitely far, as for models, ask for more than that of whoever looks at the pictures on a screen.
RenderOptions with_eyes_of_demo(RenderOptions o) {
  const bool asked = o.rig.places_eyes() || o.rig.units_per_metre || o.camera.lens.headset() ||
                     o.camera.lens.vr180() || !o.camera.file.empty() || o.camera.made_up() ||
                     o.camera.along_path();
  if (asked || o.rig.mono || !is_built_in(o.scene.name)) return o;
  if (o.scene.name == demo_room_name) {
    // A plant stands half a metre from the first view, and that looks out of the window.
    o.rig.ipd = 0.020;
    o.rig.convergence = 1.2;
    log_info(
        "{}: eyes 20 mm apart and the screen at 1.2 m, which is comfortable so near to its plant (--ipd 63mm "
        "--convergence inf: as a head sees it)",
        o.scene.name);
  } else if (o.scene.name == demo_city_name) {
    o.rig.convergence = 5.0;
    log_info("{}: the screen at 5 m (--convergence METRES for another, or inf)", o.scene.name);
  }
  return o;
}

ExitCode render(const RenderOptions& asked) {
  check(asked);
  RenderOptions o = with_eyes_of_demo(asked);
  std::unique_ptr<gl::Context> context;  // outlives what draws with it
  Work work{.outputs = outputs_of(o), .policy = policy_of(o.drawing)};
  const std::vector<fs::path> sequence = sequence_of(o);
  if (!sequence.empty()) o.scene.name = sequence[0].string();
  work.list = find_list(o, work.outputs);
  check_views(o.camera.views, o.rig.mono, work.list);
  work.photos = photo_source(o.scene.name, photos_folder(o.output.photos, work.list), o.output.exposure);
  note_photos(work.photos.folder);
  check_photos_drawn(o, work);
  const render::FrameSettings settings = settings_of(o.drawing);
  std::optional<DetailBudget> budget;
  if (o.scene.detail || may_share(o)) {
    work.heads_turn = work.list.path || work.outputs.vr180;  // such a picture shows what lies beside the view
    work.stream = open_for_shots(o.scene, settings, work.heads_turn);
    if (!o.scene.detail && !work.stream->files().has_errors()) work.stream.reset();
  }
  if (!work.stream && o.output.detail_report)
    fail("--detail-report: {} does not say what its levels lose, to share --quality with: give --detail PX",
         o.scene.name);
  if (!work.stream && o.scene.gpu_memory) budget = detail_budget(o, work.list);
  Model loaded;
  if (!work.stream) {
    // The model is read while the driver begins; with --resume there may be nothing left to draw.
    auto loading =
        std::async(std::launch::async, [&] { return load_scene(o.scene, budget, work.list.cameras); });
    if (!o.resume) context = open_context(o.context);
    loaded = loading.get();
  }
  const Model& model = work.stream ? work.stream->model() : loaded;
  log_model(o.scene.name, o.drawing.decode, model, work.stream.get());
  work.policy.check_perspective(settings, model);
  work.policy.check_model(model);
  if (!work.list.listed) work.list = made_up_cameras(o.scene, o.camera, work.list.known, model);

  const double near_plane = near_plane_of(o.camera, work.list);
  work.shots = plan_shots(o, work, sequence, near_plane, model.axes);
  if (!work.photos.folder.empty() && !work.list.listed)
    check_any_photo(work.photos.folder, work.list.cameras);
  work.screen = shot_for_screen(o, work.outputs, work.shots);
  const std::vector<shared::View> first =
      views_of(work.shots[0]);  // whichever part of the views is drawn here
  const std::optional<ordered_json> run = take_what_is_left(o, near_plane, work);
  if (work.shots.empty()) return ExitCode::done;
  if (!context) context = open_context(o.context);
  if (work.stream) {
    work.stream->gpu_model(*context, settings.precision);
    work.stream->settle(first, settings);
  }
  RenderReport report{o,
                      work.outputs,
                      model,
                      *context,
                      near_plane,
                      memory_needs(o, work, near_plane, model),
                      finite(o.rig.convergence)};
  log_info("GPU memory: {} for the model, at least {} for a frame", megabytes(report.needs.model),
           megabytes(report.needs.frame));
  if (o.output.output.empty()) claim_folder(work.outputs.folder, asked.scene.name);
  draw_all(*context, work, report);
  check_alone(work.outputs.folder, run);
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
      "  binosplat render frames/ --fps 30 --mono -o moving.mp4                  # a model a frame\n"
      "  binosplat render garden.ply --view all --shard $I/8 --resume -o out     # on 8 machines\n"
      "  binosplat render garden.ply --tour 0.5,30 --seconds 2 --preset headset --quality 40 -o frames");
  sub->callback([options, sub, &command] {
    check_together(*sub);
    options->given = options_given(*sub);
    command = [options] { return render(*options); };
  });
}

}  // namespace binosplat::app
