#include "app/scene_options.h"

#include <cctype>
#include <cmath>

#include "app/option_checks.h"
#include "base/error.h"
#include "base/numbers.h"
#include "demo/demo.h"
#include "formats/registry.h"
#include "lab/settings.h"
#include "scene/axes.h"

namespace binosplat::app {

void add_scene_options(CLI::App& sub, SceneOptions& o) {
  std::string formats = names_of_formats();
  constexpr std::size_t columns = 62;  // width of help beside the options' names
  formats[formats.rfind(' ', columns)] = '\n';
  sub.add_option("SCENE", o.name,
                 "A model's file or folder, in one of the formats\n" + formats +
                     ";\nor a built-in one: demo:room, a room, or demo:city, streets of any size")
      ->required();
  sub.option_defaults()->group("Scene");
  add_format_option(sub, o);
  add_lod_option(sub, o, "Level of detail of a streamed SOG, 0 the finest (the finest complete one)");
  add_parsed(
      sub, "--detail", "Npx|NdB", o.detail, [](const std::string& text) { return lab::parse_detail(text); },
      "Levels of a streamed SOG for each view, the same for both eyes. 5px:\nneighbouring Gaussians at "
      "most 5 px apart, 0px the finest that fit; 40dB\n(20 to 80): that PSNR against the finest, in folders "
      "of `binosplat levels`\n(render: the finest, always; view: 0px)");
  add_value(sub, "--gpu-memory", "MB", o.gpu_memory, positive,
            "Choose levels of a streamed SOG that fit into MB, the finest near the\neyes; for each view with "
            "--detail, else one choice for all");
  add_axes_option(sub, o);
  auto* antialias = sub.add_flag_callback(
      "--antialias", [&o] { o.antialias = true; },
      "Draw as a model that was trained with anti-aliasing (gsplat's,\nMip-Splatting's); default: as its "
      "file, or the run beside it, says");
  sub.add_flag_callback(
         "--no-antialias", [&o] { o.antialias = false; }, "Draw as a model that was trained without it")
      ->excludes(antialias);
  add_value(sub, "--eps2d", "PX2", o.kernel_px2, positive,
            "Low-pass: variance in px^2 that each projected Gaussian gains, as gsplat's\neps2d (0.3; 0.1 for "
            "Mip-Splatting's files)");
  add_value(sub, "--appearance", "N", o.appearance, whole_number,
            "Row of a Scaffold-GS model's appearance embedding (0)");
  add_seed_option(sub, o);
  add_count_option(sub, o, "Gaussians of demo:city, 10000 to 100000000 (1000000)");
  add_repeat_options(sub, o);
  add_place_option(sub, o);
}

CLI::Option* add_lod_option(CLI::App& sub, SceneOptions& o, const char* help) {
  return add_value(sub, "--lod", "N", o.lod, range(0, 100), help);
}

CLI::Option* add_axes_option(CLI::App& sub, SceneOptions& o) {
  const auto parse = [](std::string axes) {
    for (char& c : axes) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    world_from_axes(axes);
    return axes;
  };
  return add_parsed(
      sub, "--axes", "XYZ", o.axes, parse,
      "Directions of the model's x, y and z in the cameras' world: Right or\nLeft, Up or Down, Forward or "
      "Back, as in rdf or rub (the format's; for\nan spz without them: by its cameras)");
}

void add_format_option(CLI::App& sub, SceneOptions& o) {
  add_parsed(
      sub, "--format", "NAME", o.format, [](const std::string& name) { return row_named(name).name; },
      "Read the model as spz, .splat or another of the formats, whatever its\ncontent seems to be");
}

void add_place_option(CLI::App& sub, SceneOptions& o) {
  add_value(sub, "--place", "FILE", o.place, CLI::ExistingFile.description(""),
            "Other models in the scene's world: JSON, a list of {\"model\": PATH\nor demo:room, \"matrix\": "
            "16 numbers as in a node of glTF,\n\"opacity\": 0 to 1}");
}

void add_repeat_options(CLI::App& sub, SceneOptions& o) {
  const auto parse = [](const std::string& text) {
    return parse_two("--repeat", text, "copies along x and z as NXxNZ, for one 4x4");
  };
  add_parsed(sub, "--repeat", "NXxNZ", o.repeat, parse, "Copies of the scene along x and z; needs --spacing");
  add_value(sub, "--spacing", "S", o.spacing, positive, "Distance between copies, in world units");
}

CLI::Option* add_seed_option(CLI::App& sub, SceneOptions& o) {
  return add_value(sub, "--seed", "N", o.seed, whole_number, "Seed of demo:city (1)");
}

CLI::Option* add_count_option(CLI::App& sub, SceneOptions& o, const char* help) {
  return add_value(sub, "--count", "N", o.count, whole_number, help);
}

void check(const SceneOptions& o) {
  if (o.name != demo_city_name && (o.seed || o.count))
    fail("{} is for {}, not for {}", o.seed ? "--seed" : "--count", demo_city_name, o.name);
  const char* const of_files = o.lod && o.place.empty() ? "--lod"
                               : o.gpu_memory           ? "--gpu-memory"
                               : o.detail               ? "--detail"
                               : o.appearance           ? "--appearance"
                               : !o.format.empty()      ? "--format"
                               : !o.axes.empty()        ? "--axes"
                                                        : nullptr;
  if (of_files != nullptr && is_built_in(o.name)) fail("{} is for model files, not for {}", of_files, o.name);
  if (o.repeat.has_value() != o.spacing.has_value())
    fail("--repeat and --spacing go together: how many copies, and how far apart");
}

}  // namespace binosplat::app
