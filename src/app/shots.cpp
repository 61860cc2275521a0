#include "app/shots.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <set>

#include "base/error.h"
#include "base/inputs.h"
#include "base/log.h"
#include "formats/cameras_file.h"
#include "scene/axes.h"
#include "scene/framing.h"

namespace binosplat::app {

namespace {

constexpr int made_up_width = 1280;
constexpr int made_up_height = 720;

// A view by name: one camera, a head or itself, or a pair of eyes.
struct Choice {
  std::string name;
  std::vector<Camera> cameras;
};

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// The cameras as views in their order; where pairs are wanted, a NAME_left and its NAME_right are the one
// view NAME.
std::vector<Choice> all_choices(const std::vector<Camera>& cameras, bool pairs) {
  std::vector<Choice> choices;
  std::set<std::string> taken;
  for (const Camera& camera : cameras) {
    const std::string& name = camera.name;
    const std::string ending = ends_with(name, "_left") ? "_left" : ends_with(name, "_right") ? "_right" : "";
    const std::string pair = name.substr(0, name.size() - ending.size());
    const auto eyes = pairs && !ending.empty() ? stereo::find_eyes(cameras, pair) : std::nullopt;
    if (!eyes) {
      choices.push_back({name, {camera}});
    } else if (taken.insert(pair).second) {
      choices.push_back({pair, {(*eyes)[0], (*eyes)[1]}});
    }
  }
  return choices;
}

[[noreturn]] void fail_unknown(const std::string& name, const CameraList& list) {
  constexpr std::size_t shown = 8;
  std::string names;
  for (std::size_t i = 0; i < std::min(shown, list.cameras.size()); ++i)
    names += "\n  " + list.cameras[i].name;
  if (list.cameras.size() > shown) names += fmt::format("\n  and {} more", list.cameras.size() - shown);
  fail("--view {}: {} has no camera of this name. It has:{}", name, list.source, names);
}

Choice choose(const std::string& name, const CameraList& list, bool mono) {
  const auto exact =
      std::find_if(list.cameras.begin(), list.cameras.end(), [&](const Camera& c) { return c.name == name; });
  if (exact != list.cameras.end()) return {name, {*exact}};
  const auto eyes = stereo::find_eyes(list.cameras, name);
  if (!eyes) fail_unknown(name, list);
  if (mono) fail("--view {0} is a pair of eyes: with --mono name one of them, {0}_left or {0}_right", name);
  return {name, {(*eyes)[0], (*eyes)[1]}};
}

std::vector<Choice> chosen(const RenderOptions& options, const CameraList& list) {
  const bool everything =
      !list.listed || along_path(options) || options.views == std::vector<std::string>{"all"};
  if (everything || options.views.empty()) {
    std::vector<Choice> choices = all_choices(list.cameras, !options.mono);
    if (everything || choices.size() == 1) return choices;
    log_info("{} has {} views; drawing the first, {} (--view NAME... or --view all for others)", list.source,
             choices.size(), choices[0].name);
    choices.resize(1);
    return choices;
  }
  std::vector<Choice> choices;
  for (const std::string& name : options.views) choices.push_back(choose(name, list, options.mono));
  return choices;
}

stereo::EyePair rig_of(const RenderOptions& options, const Choice& choice, double near_plane) {
  if (choice.cameras.size() == 1) {
    return stereo::make_rig(sized(options, choice.cameras[0]), rig_settings(options, near_plane));
  }
  if (options.ipd || options.convergence || options.cant) {
    fail("view {} is a pair of eyes that the cameras give: leave --ipd, --convergence and --cant out",
         choice.name);
  }
  if (options.preset == "headset") {
    fail(
        "view {} is a pair of eyes with lenses of their own, which --preset headset would replace: use "
        "--size",
        choice.name);
  }
  return stereo::rig_from_eyes(sized(options, choice.cameras[0]), sized(options, choice.cameras[1]),
                               near_plane);
}

void add_eyes(const RenderOptions& options, const Choice& choice, double near_plane, const std::string& axes,
              Shot& shot) {
  if (options.mono) {
    const Camera camera = sized(options, choice.cameras[0]);
    shot.eyes = {{"", camera, make_view(into_axes(camera, axes), near_plane)}};
    return;
  }
  const stereo::EyePair pair = rig_of(options, choice, near_plane);
  Choice entered = choice;
  for (Camera& camera : entered.cameras) camera = into_axes(camera, axes);
  const stereo::EyePair drawn = rig_of(options, entered, near_plane);
  for (std::size_t k = 0; k < 2; ++k) {
    const std::string side = k == 0 ? "left" : "right";
    if (options.only.empty() || options.only == side)
      shot.eyes.push_back({side, pair.cameras[k], drawn.views[k]});
  }
  shot.given_eyes = choice.cameras.size() == 2;
  const double apart = glm::length(pair.cameras[1].position - pair.cameras[0].position);
  shot.ipd =
      choice.cameras.size() == 1 ? rig_settings(options, near_plane).ipd : apart / units_per_metre(options);
}

// A view's name as a file's: trainers' names may have folders, and the endings of the photos.
std::string stem_of(std::string name, std::set<std::string>& taken) {
  std::string lower = name;
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const char* ending : {".png", ".jpg", ".jpeg"}) {
    if (ends_with(lower, ending)) name.resize(name.size() - std::string(ending).size());
  }
  std::replace(name.begin(), name.end(), '/', '_');
  if (name.empty()) name = "view";
  if (name[0] == '.') name[0] = '_';
  std::string unique = name;
  for (int n = 2; !taken.insert(unique).second; ++n) unique = fmt::format("{}_{}", name, n);
  return unique;
}

}  // namespace

double near_plane_of(const RenderOptions& options, const CameraList& list, const Model& model) {
  if (options.near_plane) return *options.near_plane;
  return list.near_plane.value_or(list.listed ? near_default : near_for(model));
}

stereo::RigSettings rig_settings(const RenderOptions& options, double near_plane) {
  stereo::RigSettings settings;
  settings.ipd = options.ipd.value_or(options.saved ? options.saved->ipd : settings.ipd);
  settings.units_per_metre = units_per_metre(options);
  settings.convergence = options.convergence;
  settings.cant_degrees = options.cant.value_or(settings.cant_degrees);
  settings.near_plane = near_plane;
  return settings;
}

std::vector<shared::View> views_of(const Shot& shot) {
  std::vector<shared::View> views;
  for (const Eye& eye : shot.eyes) views.push_back(eye.view);
  return views;
}

Camera sized(const RenderOptions& options, const Camera& camera) {
  Camera out = options.preset.empty() ? camera : stereo::apply_preset(camera, options.preset);
  return options.size ? resized(out, options.size->x, options.size->y) : out;
}

glm::dvec3 up_of(const RenderOptions& options) {
  return options.up.value_or(options.saved ? options.saved->up : default_up);
}

std::optional<SavedPose> find_saved(const RenderOptions& options) {
  if (options.scene.rfind("demo:", 0) == 0) return std::nullopt;
  auto saved = find_pose(options.scene);
  if (saved)
    log_info("{}: {} world units a metre, eyes {} m apart, unless options say otherwise",
             pose_path(options.scene).string(), saved->units_per_metre, saved->ipd);
  return saved;
}

std::optional<CameraList> saved_camera(const RenderOptions& options) {
  const RenderOptions& o = options;
  const bool chosen = !o.cameras.empty() || !o.views.empty() || along_path(o) || !o.photos.empty() || o.eye ||
                      o.orbit || o.up || o.fov;
  if (!o.saved || chosen) return std::nullopt;
  return CameraList{pose_path(o.scene).string(), {o.saved->camera}, true, o.saved->near_plane};
}

CameraList listed_cameras(const RenderOptions& options, const std::vector<Camera>& built_in) {
  if (options.eye || options.orbit) return {};
  std::string file = options.path.empty() ? options.cameras : options.path;
  if (file.empty() && built_in.empty()) {
    const auto found = find_cameras(options.scene);
    if (found) {
      file = found->string();
      note_input(*found);
    }
  }
  CameraList list = file.empty() ? CameraList{options.scene, built_in} : CameraList{file, load_cameras(file)};
  list.listed = !list.cameras.empty();
  if (list.listed && (options.up || options.fov)) {
    fail(
        "--up and --fov are for cameras that are made up: {} has cameras; use --eye and --at, or --orbit, "
        "with them",
        list.source);
  }
  if (!list.listed && !options.views.empty()) {
    fail("--view {}: no cameras beside {}; name their file with --cameras", options.views[0], options.scene);
  }
  return list;
}

CameraList made_up_cameras(const RenderOptions& options, const Model& model) {
  const double fov = options.fov.value_or(default_fov_degrees);
  const glm::dvec3 up = up_of(options);
  if (options.eye) {
    return {"--eye", {look_at(*options.eye, *options.at, up, fov, made_up_width, made_up_height)}};
  }
  if (options.orbit) return {"--orbit", orbit(model, *options.orbit, made_up_width, made_up_height, fov, up)};
  log_info("no cameras beside {}: framing the model", options.scene);
  return {options.scene, {frame_model(model, made_up_width, made_up_height, fov, up)}};
}

std::vector<Shot> make_shots(const RenderOptions& options, const CameraList& list, double near_plane,
                             const std::string& axes) {
  std::vector<Shot> shots;
  std::set<std::string> taken;
  for (const Choice& choice : chosen(options, list)) {
    Shot& shot = shots.emplace_back(Shot{choice.name, stem_of(choice.name, taken), {}, {}, false});
    add_eyes(options, choice, near_plane, axes, shot);
  }
  return shots;
}

}  // namespace binosplat::app
