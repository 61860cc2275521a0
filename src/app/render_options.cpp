#include "app/render_options.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <array>

#include "app/foveate_options.h"
#include "app/option_checks.h"
#include "app/tour.h"
#include "app/vr180.h"
#include "base/error.h"
#include "formats/streamed_sog.h"
#include "preview/keys.h"

namespace binosplat::app {

namespace {

void check_cameras(const CameraOptions& o, const OutputOptions& output, bool frames) {
  if (o.eye.has_value() != o.at.has_value())
    fail("--eye and --at go together: where the camera is, and what it looks at");
  if (o.eye && o.orbit) fail("--eye and --orbit: choose one of them");
  if (o.made_up() && (!o.file.empty() || !o.views.empty())) {
    fail("{} makes its own camera: leave --cameras and --view out", o.eye ? "--eye" : "--orbit");
  }
  const bool others = o.made_up() || !o.views.empty() || frames;
  if (o.tour && (others || !o.path.empty())) {
    fail(
        "--tour goes through all cameras of the scene or of --cameras, each frame drawn once: leave --view, "
        "--path, --eye, --orbit and --frames out");
  }
  if (o.tour && !output.photos.empty())
    fail("--photos with --tour: between the cameras no photos were taken");
  if (o.seconds && !o.along_path())
    fail("--seconds is for --tour, how much of it is drawn, and for --path, how long its way takes");
  if (o.keys && (o.path.empty() || o.seconds))
    fail("--keys draws the keys of --path FILE alone: name that, and leave --seconds out");
  if (!o.path.empty() && (others || !o.file.empty())) {
    fail(
        "--path names its own cameras, each frame drawn once: leave --cameras, --view, --eye, --orbit and "
        "--frames "
        "out");
  }
  if (o.fov && o.lens.headset())
    fail("--fov with --preset headset: the preset's lens has 100 degrees across");
}

// What needs both eyes, or the camera itself.
void check_eyes(const RigOptions& rig, const DrawingOptions& drawing, const OutputOptions& output) {
  if (rig.one_picture() && drawing.decode == DECODE_CYCLOPEAN)
    fail("--decode cyclopean is for both eyes together: leave --mono and --only out");
  if (rig.one_picture() && output.show == SHOW_DISAGREEMENT)
    fail("--show disagreement is between both eyes: leave --mono and --only out");
  if (!rig.mono && !output.photos.empty())
    fail("--photos needs --mono: a photo shows what the camera sees, not an eye beside it");
}

// What is drawn in parts must not go by what would have been drawn before it.
void check_regions(const RenderOptions& o) {
  if (o.shard.all() && !o.resume) return;
  const char* const part = o.resume ? "--resume" : "--shard";
  if (o.scene.detail && (o.camera.along_path() || o.camera.lens.vr180())) {
    fail("{} with --detail: a view's levels go by those of the view before it; take --lod or --gpu-memory",
         part);
  }
  if (o.camera.along_path() && o.drawing.quality) {
    fail(
        "{} with --quality along a path: a frame's tolerance goes by the frames before it; draw the path "
        "in one run, or give --tolerance or --calibration instead",
        part);
  }
  if (o.camera.along_path() && render::measures(o.drawing.transmittance)) {
    fail(
        "{} with --transmittance {} along a path: a frame goes by what those before it measured; draw "
        "the path in one run, or take another --transmittance",
        part, transmittance_choices[o.drawing.transmittance].name);
  }
  if (o.resume && !(o.output.json.empty() && o.output.photos.empty()))
    fail("--json and --photos tell of all views, and --resume leaves out those that are there: choose");
}

// What a window that goes where its user goes does not do.
constexpr std::array render_only = {"--mono", "--only",   "--preset",      "--orbit",
                                    "--path", "--frames", "--calibration", "--reference-until"};
// What a window's system decides, and a headset does not.
constexpr std::array not_in_windows = {"--backend", "--device"};

std::string keys_text() {
  std::string text = "Keys and buttons in the window:\n";
  for (const preview::KeyHelp& key : preview::key_help)
    text += fmt::format("  {:<15}{}\n", key.keys, key.what);
  return text;
}

}  // namespace

void add_picture_options(CLI::App& sub, RenderOptions& o, bool in_window) {
  add_scene_options(sub, o.scene);
  add_camera_options(sub, o.camera);
  add_rig_options(sub, o.rig);
  add_drawing_options(sub, o.drawing, in_window);
  add_context_options(sub, o.context);
}

void add_options(CLI::App& sub, RenderOptions& o) {
  add_picture_options(sub, o, false);
  add_vr180_option(sub, o.camera.lens);
  add_foveate_option(sub, o.foveate);
  add_tour_options(sub, o.camera);
  add_output_options(sub, o.output);
  add_shard_option(sub, o.shard, "Draw every Nth view from the Ith on: one job of N");
  sub.add_flag(
      "--resume", o.resume,
      "Leave out the views whose pictures an earlier run with --resume and the\nsame options has left");
  sub.option_defaults()->group("Options");
}

void add_view_options(CLI::App& sub, RenderOptions& o) {
  add_picture_options(sub, o, true);
  add_look_options(sub, o.output, true);
  sub.add_option("-o,--output", o.output.output, "A folder for pictures and paths (out/SCENE)")
      ->type_name("DIR");
  sub.add_option(
         "--fps", o.output.fps,
         "Of a folder with the models of a moving scene: show so many a second, or\nas many as can be "
         "read")
      ->type_name("N")
      ->check(fps_range);
  add_headset_options(sub, o.headset);
  add_foveate_option(sub, o.foveate);
  sub.get_option("--foveate")->group("Headset");
  sub.option_defaults()->group("Options");
  sub.get_option("--size")->description("Pixels of the window (1280x720, or more where displays are dense)");
  sub.get_option("--view")->description("The camera to start at, by name (the first)")->type_name("NAME");
  for (const char* name : render_only) sub.get_option(name)->group("");  // understood, but in no help
  for (const char* name : not_in_windows) sub.get_option(name)->group("Headset");
  sub.footer(keys_text());
  sub.parse_complete_callback([&sub, &o] {
    for (const char* name : render_only) {
      if (sub.count(name) > 0) fail("{} is for `binosplat render`: leave it out", name);
    }
    for (const char* name : not_in_windows) {
      if (sub.count(name) > 0 && !o.headset.xr)
        fail("{} is for `binosplat render`, and for --xr: leave it out", name);
    }
    check(o.headset, sub);
  });
}

bool may_share(const RenderOptions& o) {
  return o.drawing.quality && !o.scene.lod && !o.scene.repeat && !is_built_in(o.scene.name) &&
         is_streamed_sog(o.scene.name);
}

void check(const RenderOptions& o) {
  check(o.scene);
  if (o.output.detail_report && !o.scene.detail && !may_share(o))
    fail("--detail-report tells what --detail costs, which is missing");
  if (o.scene.detail && o.scene.detail->db && o.drawing.quality &&
      *o.scene.detail->db <= *o.drawing.quality) {
    fail(
        "--detail {}dB with --quality {} leaves nothing for what a frame leaves out: leave --detail out, and "
        "levels get half of what may be lost",
        *o.scene.detail->db, *o.drawing.quality);
  }
  check_cameras(o.camera, o.output, o.drawing.frames > 1);
  check(o.drawing);
  check(o.rig);
  check_eyes(o.rig, o.drawing, o.output);
  if (o.drawing.reference_until == render::Stage::blend && o.output.show >= SHOW_ALPHAS) {
    fail("--show {}: the GPU's blend tells it, which --reference-until blend leaves out",
         show_choices[o.output.show].name);
  }
  if (o.drawing.reference_until == render::Stage::blend && o.output.exr_depth == Depth::median)
    fail("--exr-depth median: the GPU's blend tells it, which --reference-until blend leaves out");
  check_regions(o);
  check_vr180(o);
  check_foveate(o);
  check(o.context);
}

}  // namespace binosplat::app
