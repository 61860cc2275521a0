// binosplat-view: the preview as a separate program, so that binosplat links no window system.

#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>

#include "app/bench/profile.h"
#include "app/command.h"
#include "app/command_line.h"
#include "app/models/level_options.h"
#include "app/models/load_scene.h"
#include "app/options/checks.h"
#include "app/render/outputs.h"
#include "app/render/shot_settings.h"
#include "app/render/shots.h"
#include "app/viewer/headset.h"
#include "base/log.h"
#include "base/memory.h"
#include "preview/window.h"

namespace binosplat::app {

#ifndef BINOSPLAT_XR
void view_in_headset(const Options&, const preview::Opened&, preview::Choices) {
  throw Error(
      ExitCode::no_gl,
      "--xr: this binosplat was built without OpenXR's headers (on Debian libopenxr-dev): install them and "
      "build it again, as ./demo --view does");
}
#endif

namespace {

namespace fs = std::filesystem;

void check_view(const Options& o) {
  check(o);
  if (o.camera.views.size() > 1)
    fail("--view {}: the window starts at one camera, and goes on to the next with N: name one",
         fmt::join(o.camera.views, " "));
}

preview::Choices choices_of(const Options& o) {
  preview::Choices choices;
  choices.layout = o.picture.layout.value_or(LAYOUT_PARALLEL);
  choices.settings = settings_of(o.drawing);
  choices.settings.background = choices.background = o.picture.backdrop();
  choices.rig = rig_settings(o.rig, {});  // until the model is loaded
  choices.show = o.picture.show;
  choices.seeks_screen = !o.rig.convergence;
  return choices;
}

// Opens a scene. The cameras of an eye pair are separate views here.
preview::Opened open(const Options& o) {
  const SceneOptions& scene = o.scene;
  const auto saved = find_saved(scene);
  const CameraList list = listed_cameras(scene, o.camera, o.rig, saved);
  const auto pose = saved_camera(scene, o.camera, saved);
  const render::FrameSettings settings = settings_of(o.drawing);
  preview::Opened opened;
  opened.name = scene.name;
  opened.folder = o.output;
  if (opened.folder.empty()) {
    opened.folder = default_folder(scene.name);
    opened.claim = [folder = opened.folder, name = scene.name] { claim_folder(folder, name); };
  }
  check_output(opened.folder / "picture");
  if (!is_built_in(scene.name)) opened.pose_file = pose_path(scene.name);
  opened.load = [scene, settings, cameras = list.cameras] {
    return open_for_frames(scene, settings, cameras);
  };
  opened.start = [o, list, pose, settings, calibrated = calibrated_threshold_of(o.drawing)](
                     gl::Context& context, const OpenedModel<Stream>& held, preview::Choices& choices,
                     const glm::ivec2& eye) {
    const Model& model = held.model();
    Options sized = o;
    sized.camera.lens.size = eye;
    calibrated.check_model(model);
    // A reload keeps the K of the same model.
    const bool is_known =
        choices.calibrated.is_calibrated() && adagscale::is_of(choices.calibrated.calibration(), model);
    if (!is_known) choices.calibrated = calibrated;
    const CameraList all =
        list.listed ? list : generate_cameras(o.scene, sized.camera, o.rig, list.hints, model);
    const stereo::RigSettings found =
        rig_settings(o.rig, all.hints, near_plane_of(o.camera, pose ? *pose : all, model));
    calibrated.check_drawing(settings, model, found.near_plane);
    choices.rig.ipd = found.ipd;
    choices.rig.units_per_metre = found.units_per_metre;
    choices.rig.near_plane = found.near_plane;
    choices.settings = calibrated.with_rule(choices.settings);
    // For a headset the library finds K, unless it is to be written.
    const bool by_library =
        o.headset.xr && finds_k(o.drawing) && !held.stream && o.drawing.calibration.empty();
    if (measures_model(o.drawing) && !by_library && !is_known)
      measure_adagscale(o.headset.xr ? o : sized, held.gpu_model(context, settings.precision),
                        held.stream != nullptr, all, found.near_plane, choices.calibrated, choices.settings);
    std::vector<Camera> cameras = all.cameras;
    if (!o.camera.views.empty()) {
      const std::string& name = o.camera.views[0];
      const auto at =
          std::find_if(cameras.begin(), cameras.end(), [&](const Camera& c) { return c.name == name; });
      if (at == cameras.end()) fail("--view {}: {} has no camera of this name", name, list.source);
      std::rotate(cameras.begin(), at, cameras.end());
    }
    if (pose) cameras.insert(cameras.begin(), pose->cameras[0]);
    return preview::Start{std::move(cameras), all.hints.up.value_or(default_up), list.listed};
  };
  return opened;
}

void view(const Options& o) {
  check_view(o);
  const preview::Opened opened = open(o);
  if (o.headset.xr) return view_in_headset(o, opened, choices_of(o));
  preview::WindowSettings window;
  window.size = o.camera.lens.size;
  window.shader_folder = o.context.shader_dir;
  window.save_recording = [](const fs::path& to, const std::string& scene, const gl::Context& context,
                             render::Recording recording, const DrawAgain& draw) {
    save_recording(to,
                   {scene, "in the window", "as chosen there", lab::device_text(context), context.software()},
                   std::move(recording), draw);
  };
  // Outputs of another model go to another folder.
  const auto open_other = [&o](const std::string& file) {
    Options other;
    other.scene.name = file;
    other.rig.units_per_metre = o.rig.units_per_metre;
    if (!o.output.empty()) other.output = fs::path(o.output) / default_folder(file).filename();
    return open(other);
  };
  preview::run(opened, choices_of(o), window, open_other);
}

}  // namespace

}  // namespace binosplat::app

int main(int argc, char** argv) {
  using namespace binosplat::app;
  CLI::App program("binosplat view: look at a model with both eyes", "binosplat view");
  Options options;
  add_options(program, in::view, options);
  program.footer(keys_text());
  return run_program(program, argc, argv, [&] {
    program.parse(argc, argv);
    finish_options(program, in::view, options);
    view(options);
    return binosplat::ExitCode::done;
  });
}
