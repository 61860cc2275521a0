// binosplat render: from options to pictures. Checks run in the order of their cost.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <future>
#include <nlohmann/json.hpp>

#include "app/command.h"
#include "app/command_line.h"
#include "app/models/level_options.h"
#include "app/models/load_scene.h"
#include "app/open_context.h"
#include "app/options/checks.h"
#include "app/render/render_run.h"
#include "app/render/resume.h"
#include "app/render/shot_settings.h"
#include "app/render/tour.h"
#include "base/log.h"
#include "demo/demo.h"
#include "scene/framing.h"
#include "scene/scaffold.h"
#include "stereo/panorama.h"

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

// Memory of the model on the GPU, and of the shot that needs most.
render::MemoryNeeds memory_needs(const RenderRun& run) {
  render::FrameSettings settings = run.settings;
  settings.depth_table = {1.0f, {1.0f}};  // a placeholder: not measured yet
  render::MemoryNeeds most;
  for (const Shot& shot : run.shots) {
    stereo::FoveatedViews drawn{.views = views_of(shot), .settings = settings};
    std::int64_t composed = 0;  // bytes of the pictures composed of these views
    if (run.outputs.vr180) {
      // The memory of each eye's largest face. Composed pictures take 16 bytes per pixel for its ray, and 20
      // bytes per pixel and eye for colour and distance.
      const int side = shot.eyes[0].camera.width;
      drawn.views.clear();
      for (const Camera& eye : eyes_in_axes(shot, run.model().axes))
        drawn.views.push_back(make_view(stereo::panorama_face(side, eye, 0), run.near_plane));
      composed = std::int64_t{side} * side * (16 + 20 * static_cast<std::int64_t>(drawn.views.size()));
    } else if (run.options.drawing.foveation) {
      for (const shared::View& eye : drawn.views) composed += std::int64_t{eye.width} * eye.height * 20;
      drawn = stereo::foveated_views(drawn.views, settings);
    }
    const auto needs = render::memory_needs(render::make_plan(drawn.views, drawn.settings, run.model()));
    most = {needs.model, std::max(most.frame, needs.frame + composed)};
  }
  return most;
}

// Returns the shot that decides the screen's distance. Returns none if an option sets the distance, if the
// eyes have separate pictures, or if the pictures are for a headset.
std::optional<Shot> shot_for_screen(const RenderRun& run) {
  const Options& o = run.options;
  const bool flat = run.outputs.layout != LAYOUT_SEPARATE && run.outputs.layout != LAYOUT_MULTI_VIEW;
  if (!flat || run.outputs.vr180 || o.rig.convergence || o.rig.cant.value_or(0.0) != 0.0 ||
      o.camera.lens.headset() || run.list.hints.convergence)
    return std::nullopt;
  const auto head = std::ranges::find_if(run.shots, [](const Shot& shot) { return !shot.given_eyes; });
  return head == run.shots.end() ? std::nullopt : std::optional(*head);
}

// Before the model is read, checks the photos of the views to draw. Each view needs its own photo.
void check_photos_drawn(const RenderRun& run) {
  const std::string& folder = run.photos.folder;
  if (folder.empty() || !run.list.listed) return;
  check_photos_unique(folder, run.list.cameras);
  const CameraOptions& o = run.options.camera;
  std::vector<Camera> cameras = chosen_cameras(o.views, o.lens, run.list);
  if (o.views.empty() && !run.list.path) cameras.resize(1);
  check_any_photo(folder, cameras);
  check_photos(folder, cameras);
}

void log_model(const std::string& scene, const OpenedModel<PictureStream>& opened) {
  if (opened.model().scaffold) {
    log_info("{}: {}", scene, describe(*opened.model().scaffold));
  } else {
    log_info("{}: {} Gaussians{}, harmonics of degree {}", scene, opened.gaussians(),
             opened.stream ? " at first" : "", opened.model().degree);
  }
}

// The cameras that options or a saved pose choose; empty if they must be made from the model.
CameraList find_list(const Options& o, const Outputs& outputs) {
  const auto saved = find_saved(o.scene);
  // The photos belong to the training cameras, not to a saved pose.
  if (const auto pose = o.photos.empty() ? saved_camera(o.scene, o.camera, saved) : std::nullopt) {
    log_info("drawing from the pose saved there (--view or --cameras for others)");
    return *pose;
  }
  CameraList list = listed_cameras(o.scene, o.camera, o.rig, saved);
  if (o.camera.tour) return go_on_tour(o.scene, o.camera, o.rig, *outputs.fps, std::move(list));
  if (!o.camera.path.empty()) return go_along_path(o.camera, outputs.fps, outputs.video, std::move(list));
  return list;
}

// Levels the head of a shot, as a headset's wearer holds it. Keeps the heading of its gaze, the middle of its
// eyes and their distance.
void level(Shot& shot, const glm::dvec3& up) {
  const glm::dvec3 down = -glm::normalize(up);
  Camera &first = shot.eyes.front().camera, &last = shot.eyes.back().camera;
  // If the head looks straight up or down, use its own x axis.
  glm::dvec3 right = glm::cross(down, first.rotation[2] + last.rotation[2]);
  if (glm::length(right) < 1e-3) right = first.rotation[0] - glm::dot(first.rotation[0], down) * down;
  right = glm::normalize(right);
  const glm::dvec3 middle = 0.5 * (first.position + last.position);
  const double half = 0.5 * glm::length(last.position - first.position);
  first.position = middle - half * right;
  last.position = middle + half * right;
  for (Eye& eye : shot.eyes) eye.camera.rotation = glm::dmat3(right, down, glm::cross(right, down));
}

std::vector<Shot> plan_shots(const RenderRun& run) {
  const Options& o = run.options;
  std::vector<Shot> shots =
      make_shots(o.camera.views, o.camera.lens, o.rig, run.list, run.near_plane, run.model().axes);
  if (run.outputs.vr180) {
    for (Shot& shot : shots) level(shot, run.list.hints.up.value_or(default_up));
  }
  place_files(run.outputs, o.json, shots);
  return shots;
}

// Keeps only the shots that this run must draw. Returns the run's identity with --resume.
std::optional<ordered_json> select_unfinished_shots(RenderRun& run) {
  const Options& o = run.options;
  const std::size_t all = run.shots.size();
  std::optional<ordered_json> identity;
  if (o.resume) {
    protect_scene(o.scene);
    identity = identity_of(o.given);
  }
  std::vector<Shot> share;
  for (std::size_t i = o.shard.index; i < all; i += o.shard.count) share.push_back(std::move(run.shots[i]));
  run.shots = std::move(share);
  if (!o.shard.all())
    log_info("--shard {}/{}: {} of {} views", o.shard.index + 1, o.shard.count, run.shots.size(), all);
  if (identity) {
    remove_drawn_shots(run.outputs.folder, *identity, run.shots);
  } else {
    forget_run(run.outputs.folder);
  }
  return identity;
}

// Chooses comfortable eyes and a screen for a built-in scene's own views (stereo/comfort.h), unless options
// set eyes, screen, lens or path. A head's eyes with the screen at infinity, the default for models, strain
// the viewer of a screen.
Options with_demo_stereo_defaults(Options o) {
  const bool asked = o.rig.places_eyes() || o.rig.units_per_metre || o.camera.lens.headset() ||
                     o.camera.lens.vr180() || !o.camera.file.empty() || o.camera.places_cameras() ||
                     o.camera.along_path();
  if (asked || o.rig.mono || !is_built_in(o.scene.name)) return o;
  if (o.scene.name == demo_room_name) {
    // A plant stands half a metre from the first view, which also looks out of the window.
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

ExitCode render(const Options& asked) {
  check(asked);
  RenderRun run{with_demo_stereo_defaults(asked), outputs_of(asked), calibrated_threshold_of(asked.drawing)};
  Options& o = run.options;
  run.list = find_list(o, run.outputs);
  check_views(o.camera.views, o.rig.mono, run.list);
  run.photos = photo_source(o.scene.name, photos_folder(o.photos, run.list), o.exposure);
  protect_photos(run.photos.folder);
  check_photos_drawn(run);
  run.settings = run.calibrated.with_rule(settings_of(o.drawing));
  const render::FrameSettings& settings = run.settings;
  if (o.scene.detail || quality_may_choose_levels(o)) {
    run.heads_turn = run.list.path || run.outputs.vr180;  // a turning head soon sees chunks out of view
    run.opened.stream = open_for_shots(o.scene, settings, run.heads_turn);
    if (!o.scene.detail && !run.opened.stream->files().has_errors()) run.opened.stream.reset();
  }
  if (!run.opened.stream) {
    std::optional<DetailBudget> budget;
    if (o.scene.gpu_memory) budget = detail_budget(o, run.list);
    // Reads the model while the driver starts. With --resume there may be nothing to draw.
    auto loading =
        std::async(std::launch::async, [&] { return load_scene(o.scene, budget, run.list.cameras); });
    if (!o.resume) run.context = open_context(o.context);
    run.opened.whole = loading.get();
  }
  log_model(o.scene.name, run.opened);
  run.calibrated.check_model(run.model());
  if (run.photos.folder.empty() || !run.list.listed)
    run.list = cameras_that_see(o.scene, o.camera, o.rig, std::move(run.list), run.model());

  run.near_plane = near_plane_of(o.camera, run.list, run.model());
  run.calibrated.check_drawing(settings, run.model(), run.near_plane);
  run.shots = plan_shots(run);
  if (!run.photos.folder.empty() && !run.list.listed) check_any_photo(run.photos.folder, run.list.cameras);
  run.screen = shot_for_screen(run);
  const std::vector<shared::View> first = views_of(run.shots[0]);  // the same for every shard
  const std::optional<ordered_json> identity = select_unfinished_shots(run);
  if (run.shots.empty()) return ExitCode::done;
  if (!run.context) run.context = open_context(o.context);
  if (run.opened.stream) {
    run.opened.gpu_model(*run.context, settings.precision);
    run.opened.stream->settle(first, settings);
  }
  run.needs = memory_needs(run);
  run.convergence = rig_settings(o.rig, run.list.hints).convergence;
  log_info("GPU memory: {} for the model, at least {} for a frame", megabytes(run.needs.model),
           megabytes(run.needs.frame));
  if (o.output.empty()) claim_folder(run.outputs.folder, asked.scene.name);
  draw_all(run);
  check_alone(run.outputs.folder, identity);
  print(run);
  if (!o.json.empty()) save(o.json, run);
  return ExitCode::done;
}

}  // namespace

void add_render(CLI::App& program, Command& command) {
  add_command(
      program, command,
      {"render", in::render, "Draw both eyes of a model",
       "Examples:\n"
       "  binosplat render demo:room -o out/demo\n"
       "  binosplat render demo:city --count 4250000 --view all\n"
       "  binosplat render garden.ply --view DSC07956 -o pair.png\n"
       "  binosplat render garden.ply --convergence 3 --layout anaglyph -o red-cyan.png\n"
       "  binosplat render garden.ply --view all --mono --photos images -o out\n"
       "  binosplat render scan.ply --eye 0,-1.6,3 --at 0,-1,0 --convergence 2\n"
       "  binosplat render scan.ply --orbit 24 --preset headset --exr half\n"
       "  binosplat render scan.ply --orbit 120 --layout half-width -o around.mp4\n"
       "  binosplat render garden.ply --tour walk --mono -o walk.mp4\n"
       "  binosplat render garden.ply --path out/garden/cameras.json --seconds 10 -o keys.mp4\n"
       "  binosplat render garden.ply --view all --shard $I/8 --resume -o out     # on 8 machines\n"
       "  binosplat render garden.ply --tour 0.5,30 --seconds 2 --preset headset --quality 40 -o frames"},
      render);
}

}  // namespace binosplat::app
