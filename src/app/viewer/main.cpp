// binosplat-view: the preview as a program of its own, so that the other one needs no window system's
// libraries. `binosplat view` starts it.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <memory>
#include <new>

#include "app/command.h"
#include "app/command_line.h"
#include "app/drawing.h"
#include "app/followed.h"
#include "app/open_scene.h"
#include "app/render_options.h"
#include "app/render_outputs.h"
#include "app/shots.h"
#include "base/choices.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "preview/window.h"

namespace binosplat::app {

namespace {

namespace fs = std::filesystem;

void check_view(const RenderOptions& o) {
  check(o);
  if (o.mono || !o.only.empty() || o.frames > 1 || o.orbit || !o.path.empty() || o.views.size() > 1 ||
      !o.reference_until.empty() || o.quality || !o.calibration.empty() || o.backend != "auto" ||
      o.device >= 0) {
    fail(
        "--mono, --only, --frames, --orbit, --path, --reference-until, --quality, --calibration, --backend, "
        "--device and more than one --view are for `binosplat render`");
  }
  if (o.transmittance == "depth") fail("--transmittance depth is for `binosplat render`");
  if (o.layout == "multi-view") fail("--layout multi-view is for OpenEXR files of `binosplat render`");
}

preview::Choices choices_of(const RenderOptions& o) {
  preview::Choices choices;
  choices.layout = o.layout.empty() ? LAYOUT_PARALLEL : find_choice("--layout", o.layout, layout_choices);
  choices.settings = settings_of(o);
  choices.rig = rig_settings(o, near_default);  // until the model tells
  choices.background = o.background.value_or(glm::vec3(0.0f));
  choices.show = find_choice("--show", o.show, show_choices);
  return choices;
}

// The coarsest levels of a streamed SOG are there at once, the others come while one looks.
void follow_levels(const std::shared_ptr<RenderOptions>& o, preview::Opened& opened) {
  if (o->lod || o->scene.rfind("demo:", 0) == 0) return;
  const bool asked = o->detail || o->gpu_memory;
  if (!o->detail) o->detail = 0.0;
  const auto levels = std::make_shared<std::optional<StreamedSog>>();
  const auto read = [o, levels] {
    Model model = (*levels)->read();
    set_as_asked(*o, model);
    return model;
  };
  opened.load = [o, levels, read, asked, other = opened.load] {
    if (!asked && !is_streamed_sog(o->scene)) return other();
    levels->emplace(o->scene);
    (*levels)->choose({}, {});
    return read();
  };
  opened.levels = [o, levels, read](std::span<const shared::View> views) -> std::function<Model()> {
    if (!*levels || views.empty()) return nullptr;
    return (*levels)->choose(views, detail_need(*o, **levels, views)) ? std::function<Model()>(read)
                                                                      : nullptr;
  };
}

// The scene of these options, which the result keeps. Cameras that come as pairs of eyes are taken one by
// one.
preview::Opened open(const std::shared_ptr<RenderOptions>& o) {
  const auto scene = std::make_shared<Scene>(open_scene(*o));
  const auto list = std::make_shared<CameraList>(listed_cameras(*o, scene->cameras));
  const auto saved = saved_camera(*o);
  preview::Opened opened;
  opened.name = o->scene;
  opened.up = up_of(*o);
  if (o->scene.rfind("demo:", 0) != 0) opened.pose_file = pose_path(o->scene);
  opened.load = [o, scene] { return scene->model(); };
  follow_levels(o, opened);
  opened.cameras = [o, list, saved](const Model& model, preview::Choices& choices) {
    const double near_plane = near_plane_of(*o, saved ? *saved : *list, model);
    const stereo::RigSettings rig = rig_settings(*o, near_plane);
    choices.rig.ipd = rig.ipd;
    choices.rig.units_per_metre = rig.units_per_metre;
    choices.rig.near_plane = near_plane;
    std::vector<Camera> cameras = list->listed ? list->cameras : made_up_cameras(*o, model).cameras;
    if (!o->views.empty()) {
      const auto at = std::find_if(cameras.begin(), cameras.end(),
                                   [&](const Camera& c) { return c.name == o->views[0]; });
      if (at == cameras.end()) fail("--view {}: {} has no camera of this name", o->views[0], list->source);
      std::rotate(cameras.begin(), at, cameras.end());
    }
    if (saved) cameras.insert(cameras.begin(), saved->cameras[0]);
    return cameras;
  };
  return opened;
}

void view(const std::shared_ptr<RenderOptions>& options) {
  check_view(*options);
  const fs::path folder =
      options->output.empty() ? default_folder(options->scene) : fs::path(options->output);
  check_output(folder / "picture");
  preview::WindowSettings settings;
  if (options->size) settings.size = *options->size;
  settings.folder = folder;
  settings.shader_folder = options->shader_dir;
  options->saved = find_saved(*options);
  preview::run(open(options), choices_of(*options), settings, [options](const std::string& file) {
    const auto other = std::make_shared<RenderOptions>();
    other->scene = file;
    other->units_per_metre = options->units_per_metre;
    other->saved = find_saved(*other);
    return open(other);
  });
}

int end(ExitCode code, const std::string& text) {
  log_line(text);
  return static_cast<int>(code);
}

int run(int argc, char** argv) {
  CLI::App program("binosplat view: look at a model with both eyes", "binosplat view");
  const auto options = std::make_shared<RenderOptions>();
  try {
    add_view_options(program, *options);
    add_max_memory(program);
    check_arguments(argc, argv);
    program.parse(argc, argv);
    note_inputs(program);
    view(options);
    return 0;
  } catch (const CLI::Success& asked) {
    return program.exit(asked);
  } catch (const CLI::ParseError& error) {
    return end(ExitCode::bad_input, fmt::format("{}\n  see: binosplat view --help", error.what()));
  } catch (const Error& error) {
    return end(error.code(), error.what());
  } catch (const std::bad_alloc&) {
    return end(ExitCode::out_of_memory, "out of memory: the model does not fit");
  } catch (const std::exception& error) {
    return end(ExitCode::bad_input, fmt::format("internal error: {}", error.what()));
  }
}

}  // namespace

}  // namespace binosplat::app

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);
  binosplat::app::spare_full_disk();
  binosplat::end_cleanly_on_cut_files();
  return binosplat::app::run(argc, argv);
}
