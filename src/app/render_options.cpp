#include "app/render_options.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <array>
#include <utility>

#include "app/foveate_options.h"
#include "app/option_checks.h"
#include "app/option_conflicts.h"
#include "app/tour.h"
#include "base/error.h"
#include "base/text.h"
#include "formats/streamed_sog.h"
#include "preview/keys.h"
#include "stereo/panorama.h"

namespace binosplat::app {

namespace {

// Refuses --shard and --resume if pictures use earlier frames: the pictures would depend on the shard.
void check_regions(const RenderOptions& o) {
  if (o.shard.all() && !o.resume) return;
  const char* const part = o.resume ? "--resume" : "--shard";
  if (o.scene.detail && (o.camera.along_path() || o.camera.lens.vr180())) {
    fail("{} with --detail: a view's levels depend on the view before it; give --lod or --gpu-memory", part);
  }
  if (o.camera.along_path() && o.drawing.quality) {
    fail(
        "{} with --quality along a path: a frame's tolerance depends on the frames before it; draw the path "
        "in one run, or give --tolerance or --calibration instead",
        part);
  }
  if (o.camera.along_path() && render::measures(o.drawing.transmittance)) {
    fail(
        "{} with --transmittance {} along a path: a frame uses measurements of those before it; draw the "
        "path in one run, or give another --transmittance",
        part, transmittance_choices[o.drawing.transmittance].name);
  }
}

void check_vr180(const RenderOptions& o) {
  if (!o.camera.lens.vr180()) return;
  if (const auto& size = o.camera.lens.size; size && (size->x != size->y || size->x % 2 != 0)) {
    fail("--size {0}x{1} with --vr180: expected an even number of pixels twice, for one 2880x2880", size->x,
         size->y);
  }
  if (const auto& size = o.camera.lens.size; size && size->x > stereo::panorama_side_most)
    fail("--size {0}x{0} with --vr180: at most {1}x{1}", size->x, stereo::panorama_side_most);
  const int layout = o.output.layout.value_or(LAYOUT_PARALLEL);
  if (layout != LAYOUT_PARALLEL && layout != LAYOUT_OVER_UNDER && layout != LAYOUT_SEPARATE)
    fail("--vr180 with --layout {}: expected parallel, over-under or separate", layout_choices[layout].name);
  const std::string ending = lowered_ending(o.output.output);
  if (ending == ".mkv" || ending == ".webm")
    fail("-o {}: expected .mp4 or .mov, which can be marked as VR180", o.output.output);
}

void add_headset_options(CLI::App& sub, HeadsetOptions& o) {
  sub.option_defaults()->group("Headset");
  sub.add_flag("--xr", o.xr,
               "Draw in the headset of an OpenXR runtime; sticks walk and turn, grips\nhold the world");
  add_value(sub, "--scale", "FACTOR", o.scale, between(0.1, 4.0, "a factor from 0.1 to 4"),
            "Scale of both sides of the recommended pictures (1)");
  const auto parse_budget = [](const std::string& text) {
    double ms = 0.0;
    const bool good = text == "auto" || (CLI::detail::lexical_cast(text, ms) && ms > 0.0 && ms <= 1000.0);
    if (!good) fail("--frame-budget {}: expected milliseconds above 0, at most 1000, or auto", text);
    return ms;
  };
  add_parsed(sub, "--frame-budget", "MS|auto", o.budget_ms, parse_budget,
             "Reduce quality, then size, to keep frames within MS; auto: four fifths\nof the runtime's time "
             "for a frame");
  add_value(sub, "--record", "S", o.record_s, between(1e-3, 3600.0, "seconds above zero, at most 3600"),
            "Record the first S seconds as `profile` does; F8 in the mirror window\nrecords ten more");
  sub.add_flag_callback(
      "--no-mirror", [&o] { o.mirror = false; }, "Open no window with the left eye's picture");
}

// Options that conflict with a headset, and the reasons.
constexpr const char* of_windows = "leave it out, the headset determines it";
constexpr const char* of_studies = "leave it out, headsets use the tile test ellipse";
constexpr std::pair<const char*, const char*> not_in_headsets[] = {
    {"--size", of_windows},        {"--layout", of_windows}, {"--ipd", of_windows},
    {"--convergence", of_windows}, {"--cant", of_windows},   {"--show", of_windows},
    {"--fov", of_windows},         {"--output", of_windows}, {"--tiles", of_studies},
    {"--shader-dir", of_studies}};
constexpr std::pair<const char*, const char*> not_beside_a_budget[] = {
    {"--foveate", "a quality needs whole pictures: choose one of them"},
    {"--quality", "choose one, the budget chooses the quality"},
    {"--tolerance", "choose one, the budget chooses the tolerance"}};

// Throws Error for options that a headset decides itself, and for headset options without --xr.
void check_headset(const HeadsetOptions& o, const CLI::App& sub) {
  const auto is_given = [&](const char* name) {
    const CLI::Option* const option = sub.get_option_no_throw(name);
    return option != nullptr && option->count() > 0;
  };
  for (const char* name : {"--scale", "--frame-budget", "--no-mirror", "--record", "--foveate"}) {
    if (!o.xr && is_given(name)) fail("{} is for a headset: add --xr, or leave it out", name);
  }
  for (const auto& [name, why] : not_in_headsets) {
    if (o.xr && is_given(name)) fail("{} with --xr: {}", name, why);
  }
  for (const auto& [name, why] : not_beside_a_budget) {
    if (o.budget_ms && is_given(name)) fail("--frame-budget with {}: {}", name, why);
  }
}

// Options that a window with free navigation lacks.
constexpr std::array render_only = {"--mono", "--only",   "--preset",         "--orbit",
                                    "--path", "--frames", "--reference-until"};
// Options that the window system decides, but a headset's run accepts.
constexpr std::array not_in_windows = {"--backend", "--device"};

std::string keys_text() {
  std::string text = "Keys and buttons in the window:\n";
  for (const preview::KeyHelp& key : preview::key_help)
    text += fmt::format("  {:<15}{}\n", key.keys, key.what);
  return text;
}

}  // namespace

void add_picture_options(CLI::App& sub, RenderOptions& o) {
  add_scene_options(sub, o.scene);
  add_camera_options(sub, o.camera);
  add_rig_options(sub, o.rig);
  add_drawing_options(sub, o.drawing);
  add_context_options(sub, o.context);
}

void add_options(CLI::App& sub, RenderOptions& o) {
  add_picture_options(sub, o);
  sub.add_flag_callback(
         "--vr180", [&o] { o.camera.lens.preset = "vr180"; },
         "Draw VR180: level, 180 degrees wide and high ahead of each eye\n(equirectangular, 2048 x 2048 px "
         "an eye, or --size); .png, or .vr.jpg,\n.mp4 and .mov with VR180's metadata")
      ->group("Cameras");
  add_foveate_option(sub, o.foveate);
  add_tour_options(sub, o.camera);
  add_output_options(sub, o.output);
  add_shard_option(sub, o.shard, "Draw every Nth view from the Ith on: one job of N");
  sub.add_flag("--resume", o.resume,
               "Skip views whose pictures an earlier run with --resume and the same\noptions wrote");
  sub.option_defaults()->group("Options");
}

void add_view_options(CLI::App& sub, RenderOptions& o) {
  add_picture_options(sub, o);
  add_look_options(sub, o.output, true);
  sub.add_option("-o,--output", o.output.output, "A folder for pictures and paths (out/SCENE)")
      ->type_name("DIR");
  add_headset_options(sub, o.headset);
  add_foveate_option(sub, o.foveate);
  sub.get_option("--foveate")->group("Headset");
  sub.option_defaults()->group("Options");
  sub.get_option("--size")->description("Pixels of the window (1280x720, or more where displays are dense)");
  sub.get_option("--view")->description("The camera to start at, by name (the first)")->type_name("NAME");
  for (const char* name : render_only) sub.remove_option(sub.get_option(name));
  for (const char* name : not_in_windows) sub.get_option(name)->group("Headset");
  sub.footer(keys_text());
  sub.parse_complete_callback([&sub, &o] {
    check_conflicts(sub);
    for (const char* name : not_in_windows) {
      if (sub.count(name) > 0 && !o.headset.xr)
        fail("{} is for `binosplat render`, and for --xr: leave it out", name);
    }
    check_headset(o.headset, sub);
  });
}

bool quality_may_choose_levels(const RenderOptions& o) {
  return o.drawing.quality && !o.scene.lod && !o.scene.repeat && o.scene.place.empty() &&
         o.scene.format.empty() && !is_built_in(o.scene.name) && is_streamed_sog(o.scene.name);
}

void check_foveate(const RenderOptions& o) {
  if (!o.foveate) return;
  if (o.output.show >= SHOW_ALPHAS) {
    fail("--foveate with --show {}: this debug view needs one picture, and a foveated one has two",
         show_choices[o.output.show].name);
  }
  if (o.output.exr_depth == Depth::median)
    fail("--foveate with --exr-depth median: medians of inset and context cannot be mixed in the seam");
  if (o.rig.one_picture() && o.foveate->gaze.size() > 1)
    fail("--foveate gaze: two gazes are for both eyes: leave --mono and --only out, or give one");
}

void check(const RenderOptions& o) {
  check(o.scene);
  if (o.scene.detail && o.scene.detail->db && o.drawing.quality &&
      *o.scene.detail->db <= *o.drawing.quality) {
    fail(
        "--detail {}dB uses up the error that --quality {} allows: leave --detail out, and levels take half "
        "of it",
        *o.scene.detail->db, *o.drawing.quality);
  }
  if (o.camera.seconds && !o.camera.along_path())
    fail("--seconds needs --tour, of which it is a part, or --path, whose duration it is");
  if (o.camera.fov && o.camera.lens.headset())
    fail("--fov with --preset headset: the preset's lens has 100 degrees across");
  check(o.drawing);
  if (!o.output.photos.empty() && !o.rig.mono)
    fail("--photos needs --mono: a photo shows what the camera sees, not an eye beside it");
  if (o.rig.one_picture() && o.output.show == SHOW_DISAGREEMENT)
    fail("--show disagreement is between both eyes: leave --mono and --only out");
  if (o.drawing.reference_until == render::Stage::blend && o.output.show >= SHOW_ALPHAS) {
    fail("--show {} needs the GPU's blend, which --reference-until blend replaces",
         show_choices[o.output.show].name);
  }
  if (o.drawing.reference_until == render::Stage::blend && o.output.exr_depth == Depth::median)
    fail("--exr-depth median needs the GPU's blend, which --reference-until blend replaces");
  if (o.drawing.reference_until == render::Stage::blend && o.drawing.precision != PRECISION_FULL)
    fail("--precision half has no effect with --reference-until blend, which replaces all stages");
  check_regions(o);
  check_vr180(o);
  check_foveate(o);
  check(o.context);
}

}  // namespace binosplat::app
