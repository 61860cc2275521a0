#include "app/render/shots.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "app/models/load_scene.h"
#include "app/options/parse.h"
#include "base/error.h"
#include "base/inputs.h"
#include "base/log.h"
#include "formats/cameras/cameras_file.h"
#include "formats/cameras/dataparser.h"
#include "formats/cameras/view_files.h"
#include "scene/axes.h"
#include "scene/framing.h"
#include "stereo/comfort.h"

namespace binosplat::app {

namespace {

constexpr int generated_width = 1280;
constexpr int generated_height = 720;
constexpr double eye_height = 1.6;  // m, of a standing person

// A named view: one camera (a head, or the picture itself), or a pair of eyes.
struct ShotChoice {
  std::string name;
  std::vector<Camera> cameras;
};

// The cameras as views in their order. With `pairs`, NAME_left and NAME_right form the view NAME.
std::vector<ShotChoice> all_choices(const std::vector<Camera>& cameras, bool pairs) {
  std::vector<ShotChoice> choices;
  std::set<std::string> taken;
  for (const Camera& camera : cameras) {
    const std::string& name = camera.name;
    const bool is_eye = name.ends_with("_left") || name.ends_with("_right");
    const std::string pair = is_eye ? name.substr(0, name.rfind('_')) : "";
    const auto eyes = pairs && !pair.empty() ? stereo::find_eyes(cameras, pair) : std::nullopt;
    if (!eyes) {
      choices.push_back({name, {camera}});
    } else if (taken.insert(pair).second) {
      choices.push_back({pair, {(*eyes)[0], (*eyes)[1]}});
    }
  }
  return choices;
}

ShotChoice choose(const std::string& name, const CameraList& list, bool mono, const char* option) {
  const auto exact =
      std::find_if(list.cameras.begin(), list.cameras.end(), [&](const Camera& c) { return c.name == name; });
  if (exact != list.cameras.end()) return {name, {*exact}};
  const auto eyes = stereo::find_eyes(list.cameras, name);
  if (!eyes) fail_no_camera(fmt::format("{} {}", option, name), list.source, list.cameras);
  if (mono) fail("--view {0} is a pair of eyes: with --mono name one of them, {0}_left or {0}_right", name);
  return {name, {(*eyes)[0], (*eyes)[1]}};
}

std::vector<ShotChoice> chosen(const std::vector<std::string>& views, const CameraList& list, bool mono,
                               const char* option = "--view") {
  const bool everything = !list.listed || list.path || views == all_views;
  if (everything || views.empty()) {
    std::vector<ShotChoice> choices = all_choices(list.cameras, !mono);
    if (everything || choices.size() == 1) return choices;
    log_info("{} has {} views; drawing the first, {} (--view NAME or --view all for others)", list.source,
             choices.size(), choices[0].name);
    choices.resize(1);
    return choices;
  }
  std::vector<ShotChoice> choices;
  for (const std::string& name : view_names(views, list)) choices.push_back(choose(name, list, mono, option));
  return choices;
}

stereo::EyePair eyes_of(const Lens& lens, const RigOptions& rig, const stereo::RigSettings& settings,
                        const ShotChoice& choice, const ModelAxes& axes) {
  if (choice.cameras.size() == 1) return stereo::make_rig(sized(lens, choice.cameras[0]), settings, axes);
  if (rig.places_eyes()) {
    fail("view {} is a pair of eyes that the cameras give: leave --ipd, --convergence and --cant out",
         choice.name);
  }
  if (lens.headset()) {
    fail(
        "view {} is a pair of eyes with lenses of their own, which --preset headset would replace: use "
        "--size",
        choice.name);
  }
  return stereo::rig_from_eyes(sized(lens, choice.cameras[0]), sized(lens, choice.cameras[1]),
                               settings.near_plane, axes);
}

void add_eyes(const Lens& lens, const RigOptions& rig, const stereo::RigSettings& settings,
              const ShotChoice& choice, const ModelAxes& axes, Shot& shot) {
  if (rig.mono) {
    const Camera camera = sized(lens, choice.cameras[0]);
    shot.eyes = {{"", camera, make_view(into_axes(camera, axes), settings.near_plane)}};
    return;
  }
  const stereo::EyePair pair = eyes_of(lens, rig, settings, choice, axes);
  for (std::size_t k = 0; k < 2; ++k) {
    if (rig.only.value_or(k) == k)
      shot.eyes.push_back({k == 0 ? "left" : "right", pair.cameras[k], pair.views[k]});
  }
  shot.given_eyes = choice.cameras.size() == 2;
  const double apart = glm::length(pair.cameras[1].position - pair.cameras[0].position);
  shot.ipd = shot.given_eyes ? apart / settings.units_per_metre : settings.ipd;
}

SceneHints hints_of(const std::optional<SavedPose>& saved) {
  if (!saved) return {};
  return {.units_per_metre = saved->units_per_metre, .ipd = saved->ipd, .up = saved->up};
}

// Stores the up direction and the centre that the cameras of a capture suggest for new cameras, and how far
// the cameras reach.
void add_capture_hints(const std::vector<Camera>& cameras, SceneHints& hints) {
  if (!cameras.empty() && !hints.reach) {
    hints.reach = 0.0;
    for (const Camera& camera : cameras)
      for (int c = 0; c < 3; ++c) hints.reach = std::max(*hints.reach, std::abs(camera.position[c]));
  }
  const auto capture = capture_of(cameras, hints.up);
  if (!capture) return;
  if (!hints.up) hints.up = capture->up;
  hints.around = capture->around;
}

// Reads cameras and moves them into the model's world, which may differ from the file's.
std::vector<Camera> cameras_for(const std::string& scene, const std::string& file,
                                const std::optional<double>& fov = {}) {
  protect_input(file);
  for (const char* name : {"cameras.bin", "cameras.txt", "images.bin", "images.txt"})
    protect_input(std::filesystem::path(file) / name);
  std::vector<Camera> cameras = load_cameras(file, fov);
  const auto dataparser = is_built_in(scene) ? std::nullopt : find_dataparser(scene);
  if (dataparser) protect_input(*dataparser);
  if (dataparser && move_into_training(*dataparser, file, cameras))
    log_info("{}: moved into the world that the model was trained in, by {}", file, dataparser->string());
  return cameras;
}

// Calls add_capture_hints() with the cameras beside the model. Warns if they cannot be read.
void add_hints_of_cameras_beside(const std::string& scene, SceneHints& hints) {
  const auto found = find_cameras(scene);
  if (!found) return;
  try {
    add_capture_hints(cameras_for(scene, found->string()), hints);
  } catch (const Error& error) {
    log_warning("{}; cameras are made up without them", error.what());
  }
}

// The cameras of the named file, of the file beside the model, or of the built-in scene.
CameraList camera_list(const SceneOptions& scene, const CameraOptions& camera,
                       const std::vector<Camera>& built_in) {
  const std::string named = camera.path.empty() ? camera.file : camera.path;
  if (!named.empty()) return {named, cameras_for(scene.name, named, camera.fov)};
  const auto found = built_in.empty() ? find_cameras(scene.name) : std::nullopt;
  if (!found) return {scene.name, built_in};
  try {
    return {found->string(), cameras_for(scene.name, found->string(), camera.fov)};
  } catch (const Error& error) {
    if (error.code() != ExitCode::bad_input) throw;
    return {.source = scene.name, .hints = {.unusable = error.what()}};
  }
}

// Derives the up direction and the centre from the model if no cameras define them. Returns for the log how
// up and centre were found; empty if --eye and --up define all.
std::string add_hints_of_model(const CoredModel& cored, const SceneOptions& scene,
                               const CameraOptions& camera, const PictureShape& shape, SceneHints& hints) {
  if (hints.around && !camera.eye && !camera.frame)
    return "around what the cameras beside it look at (--eye and --at for other places)";
  if (camera.eye && camera.up) return "";
  const std::optional<glm::dvec3> known = is_built_in(scene.name) ? hints.up.value_or(default_up) : hints.up;
  const Viewpoint found =
      find_viewpoint(cored, shape, known, eye_height * hints.units_per_metre.value_or(1.0), camera.frame);
  const char* tells = hints.up            ? "by what lies beside it"
                      : found.up_by_floor ? "by its floor"
                                          : "as its format has it";
  hints.up = found.capture.up;
  std::string place;
  if (!camera.eye) {
    hints.around = found.capture.around;
    place =
        found.kind == Viewpoint::Kind::whole ? "the whole of it, from outside"
        : found.kind == Viewpoint::Kind::core
            ? "its middle, from outside (--frame all, or --eye and --at, for others)"
            : fmt::format("from {:.2g} units above its floor (--frame all, or --eye and --at, for others)",
                          found.eyes);
  }
  if (camera.up || is_built_in(scene.name)) return place;
  return fmt::format("{}{}up is {:.2f},{:.2f},{:.2f}, {} (--up for another)", place,
                     place.empty() ? "" : "; ", hints.up->x, hints.up->y, hints.up->z, tells);
}

// Takes eyes and a screen that are comfortable for cameras made from the model, unless options set them. A
// head's eyes with the screen at infinity, the default, strain the viewer of a screen who looks at a near
// model.
void choose_eyes(const CameraOptions& camera, const RigOptions& rig, const CoredModel& cored,
                 CameraList& list) {
  if (rig.mono || rig.places_eyes() || camera.lens.headset() || camera.lens.vr180()) return;
  const auto depths = depths_seen(list.cameras, cored);
  if (!depths) return;
  const stereo::RigSettings usual = rig_settings(rig, list.hints);
  const stereo::ComfortableRig eyes =
      stereo::comfortable_rig((*depths)[0], (*depths)[1], usual.ipd * usual.units_per_metre);
  list.hints.ipd = *eyes.ipd / usual.units_per_metre;
  list.hints.convergence = eyes.convergence / usual.units_per_metre;
  log_info("eyes {:.3g} mm apart and the screen at {:.3g} m, for comfort (--ipd 63mm: as a head sees it)",
           1000.0 * *list.hints.ipd, *list.hints.convergence);
}

}  // namespace

Camera sized(const Lens& lens, const Camera& camera) {
  const Camera out = lens.preset.empty() ? camera : stereo::apply_preset(camera, lens.preset);
  return lens.size ? resized(out, lens.size->x, lens.size->y) : out;
}

CameraList listed_cameras(const SceneOptions& scene, const CameraOptions& camera, const RigOptions& rig,
                          const std::optional<SavedPose>& saved) {
  const std::vector<Camera> built_in = built_in_cameras(scene);
  SceneHints hints = hints_of(saved);
  if (camera.lens.vr180() && !camera.file.empty()) hints.up.reset();  // the named file tells it
  if (camera.up) hints.up = camera.up;
  if (rig.units_per_metre) hints.units_per_metre = rig.units_per_metre;
  if (camera.places_cameras()) {
    if (built_in.empty()) add_hints_of_cameras_beside(scene.name, hints);
    return {.hints = hints};
  }
  CameraList list = camera_list(scene, camera, built_in);
  list.listed = !list.cameras.empty();
  list.path = camera.along_path();
  hints.unusable = list.hints.unusable;
  list.hints = hints;
  const bool holds_level = built_in.empty() && camera.lens.vr180();
  // Keys of a path may all be tilted alike. The mean of the many cameras beside the model is level.
  if (holds_level && !camera.path.empty()) add_hints_of_cameras_beside(scene.name, list.hints);
  // The size of the world shows in the cameras beside the model rather than in those of a path.
  if (built_in.empty() && !(camera.path + camera.file).empty()) {
    SceneHints beside;
    add_capture_hints(cameras_beside(scene), beside);
    list.hints.reach = beside.reach;
  }
  if (built_in.empty()) add_capture_hints(list.cameras, list.hints);
  if (holds_level && !list.hints.up && !camera.file.empty())
    add_hints_of_cameras_beside(scene.name, list.hints);
  const bool takes_fov = list.listed && camera.fov && built_in.empty() && lacks_lenses(list.source);
  if (list.listed && ((camera.up && !camera.lens.vr180()) || (camera.fov && !takes_fov))) {
    fail(
        "--up and --fov are for cameras that are made up: {} has cameras; use --eye and --at, or --orbit, "
        "with them",
        list.source);
  }
  if (!list.listed && !camera.views.empty())
    fail("--view {}: {}; name their file with --cameras", camera.views[0], why_no_cameras(scene, hints));
  return list;
}

std::string why_no_cameras(const SceneOptions& scene, const SceneHints& hints) {
  if (hints.unusable.empty()) return fmt::format("no cameras beside {}", scene.name);
  return fmt::format("the cameras beside {} cannot be used: {}", scene.name, hints.unusable);
}

std::optional<SavedPose> find_saved(const SceneOptions& scene) {
  if (is_built_in(scene.name)) return std::nullopt;
  auto saved = find_pose(scene.name);
  if (saved)
    log_info("{}: {} world units per metre, eyes {} m apart (options override them)",
             pose_path(scene.name).string(), saved->units_per_metre, saved->ipd);
  return saved;
}

std::optional<CameraList> saved_camera(const SceneOptions& scene, const CameraOptions& camera,
                                       const std::optional<SavedPose>& saved) {
  const bool chosen = !camera.file.empty() || !camera.views.empty() || camera.along_path() ||
                      camera.places_cameras() || camera.up || camera.fov;
  if (!saved || chosen) return std::nullopt;
  return CameraList{.source = pose_path(scene.name).string(),
                    .cameras = {saved->camera},
                    .listed = true,
                    .near_plane = saved->near_plane,
                    .hints = hints_of(saved)};
}

CameraList eye_camera(const CameraOptions& camera, const SceneHints& hints) {
  return {.source = "--eye",
          .cameras = {look_at(*camera.eye, *camera.at, hints.up.value_or(default_up),
                              camera.fov.value_or(default_fov_degrees), generated_width, generated_height)},
          .hints = hints};
}

CameraList generate_cameras(const SceneOptions& scene, const CameraOptions& camera, const RigOptions& rig,
                            SceneHints hints, const Model& model) {
  const double fov = camera.fov.value_or(default_fov_degrees);
  const CoredModel cored(model);
  const Camera usual = look_at({0, 0, 0}, {0, 0, 1}, default_up, fov, generated_width, generated_height);
  const std::string how =
      add_hints_of_model(cored, scene, camera, shape_of(sized(camera.lens, usual)), hints);
  CameraList list{.source = scene.name, .hints = hints};
  if (!hints.unusable.empty()) log_warning("{}; cameras are made up instead", hints.unusable);
  if (camera.eye) {
    if (!how.empty()) log_info("looking at {} from --eye: {}", scene.name, how);
    list = eye_camera(camera, hints);
  } else if (camera.orbit) {
    list.source = "--orbit";
    log_info("going around {}: {}", scene.name, how);
    list.cameras = orbit({*hints.up, hints.around}, *camera.orbit, generated_width, generated_height, fov);
  } else {
    const bool none = hints.unusable.empty() && !camera.frame;
    log_info("{} {}: {}", none ? "no cameras beside" : "one camera for", scene.name, how);
    list.cameras = {first_camera({*hints.up, hints.around}, generated_width, generated_height, fov)};
  }
  if (!camera.eye) choose_eyes(camera, rig, cored, list);
  list.near_plane = near_plane_for(cored);
  return list;
}

CameraList cameras_that_see(const SceneOptions& scene, const CameraOptions& camera, const RigOptions& rig,
                            CameraList list, const Model& model) {
  if (!list.listed) return generate_cameras(scene, camera, rig, list.hints, model);
  const bool chosen = is_built_in(scene.name) || !camera.file.empty() || !camera.views.empty() || list.path ||
                      list.near_plane;  // of a saved pose
  if (chosen || model.count() == 0) return list;
  if (any_camera_sees(list.cameras, model)) return list;
  SceneHints hints{.units_per_metre = list.hints.units_per_metre, .ipd = list.hints.ipd};
  const std::string none = list.cameras.size() == 1
                               ? "its camera does not see"
                               : fmt::format("none of its {} cameras sees", list.cameras.size());
  hints.unusable =
      fmt::format("{}: {} the model (--view {} draws one)", list.source, none, list.cameras[0].name);
  return generate_cameras(scene, camera, rig, hints, model);
}

NearPlane find_near_plane(const CameraOptions& camera, const CameraList& list, const Training& training) {
  if (camera.near_plane) return {*camera.near_plane, "--near"};
  if (list.listed && list.near_plane) return {*list.near_plane, list.source};  // a saved pose
  if (training.near_plane) return {*training.near_plane, training.near_by};
  // nerfstudio and gsplat scale the cameras to lie within a cube from -1 to 1, and train with their near
  // plane. INRIA's trainer keeps the world of COLMAP, whose cameras reach to about 4.
  constexpr double small_world = 1.2, near_in_small_world = 0.01;
  if (list.hints.reach && *list.hints.reach <= small_world)
    return {near_in_small_world, "its cameras, which reach to 1 unit as in nerfstudio"};
  if (list.near_plane) return {*list.near_plane, *list.near_plane < near_default ? "its size" : ""};
  return {near_default, ""};
}

stereo::RigSettings rig_settings(const RigOptions& rig, const SceneHints& hints, double near_plane) {
  stereo::RigSettings settings;
  settings.ipd = rig.ipd.value_or(hints.ipd.value_or(settings.ipd));
  settings.units_per_metre =
      rig.units_per_metre.value_or(hints.units_per_metre.value_or(settings.units_per_metre));
  const auto screen = rig.convergence ? rig.convergence : hints.convergence;
  if (screen != std::numeric_limits<double>::infinity()) settings.convergence = screen;
  settings.cant_degrees = rig.cant.value_or(settings.cant_degrees);
  settings.near_plane = near_plane;
  return settings;
}

void converge(Shot& shot, double metres) {
  if (shot.given_eyes || shot.eyes.size() != 2) return;
  for (Eye& eye : shot.eyes) {
    const double shift = 0.5 * eye.camera.fx * *shot.ipd / metres;
    eye.camera.cx += eye.side == "left" ? -shift : shift;
    set_lens(eye.view, eye.camera);
  }
}

namespace {

/// Returns stem_of(name), with a number if `taken` has this stem already. Adds the result to `taken`.
std::string free_stem(const std::string& name, std::set<std::string>& taken) {
  std::string stem = stem_of(name);
  for (int n = 2; !taken.insert(stem).second; ++n) stem = fmt::format("{}_{}", stem_of(name), n);
  return stem;
}

}  // namespace

std::vector<shared::View> views_of(const Shot& shot) {
  std::vector<shared::View> views;
  for (const Eye& eye : shot.eyes) views.push_back(eye.view);
  return views;
}

std::vector<Camera> eyes_in_axes(const Shot& shot, const ModelAxes& axes) {
  std::vector<Camera> eyes;
  for (const Eye& eye : shot.eyes) eyes.push_back(into_axes(eye.camera, axes));
  return eyes;
}

std::vector<std::string> view_names(const std::vector<std::string>& texts, const CameraList& list) {
  return separated(texts, [&](const std::string& text) {
    return stereo::find_eyes(list.cameras, text) ||
           std::ranges::any_of(list.cameras, [&](const Camera& c) { return c.name == text; });
  });
}

void check_views(const std::vector<std::string>& views, bool mono, const CameraList& list) {
  if (!list.listed || list.path || views == all_views) return;
  for (const std::string& name : view_names(views, list)) choose(name, list, mono, "--view");
}

std::vector<Camera> chosen_cameras(const std::vector<std::string>& views, const Lens& lens,
                                   const CameraList& list, const char* option) {
  std::vector<Camera> cameras;
  for (const ShotChoice& choice : chosen(views.empty() ? all_views : views, list, true, option))
    cameras.push_back(sized(lens, choice.cameras[0]));
  return cameras;
}

std::vector<Shot> make_shots(const std::vector<std::string>& views, const Lens& lens, const RigOptions& rig,
                             const CameraList& list, double near_plane, const ModelAxes& axes) {
  const stereo::RigSettings settings = rig_settings(rig, list.hints, near_plane);
  std::vector<Shot> shots;
  std::set<std::string> taken;
  for (const ShotChoice& choice : chosen(views, list, rig.mono)) {
    Shot& shot = shots.emplace_back();
    shot.name = choice.name;
    shot.stem = free_stem(choice.name, taken);
    shot.units_per_metre = settings.units_per_metre;
    add_eyes(lens, rig, settings, choice, axes, shot);
  }
  return shots;
}

}  // namespace binosplat::app
