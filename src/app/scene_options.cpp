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
                 "A model's file or folder, of the formats\n" + formats +
                     ";\nor one that is built in: demo:room, a room, or demo:city, streets\nof any size")
      ->required();
  sub.option_defaults()->group("Scene");
  add_lod_option(sub, o, "Level of detail of a streamed SOG, 0 the finest (the finest that\nis there)");
  add_parsed(
      sub, "--detail", "PX|DB", o.detail, [](const std::string& text) { return lab::parse_detail(text); },
      "Of a streamed SOG instead: for each view levels whose Gaussians are\nseen no farther than PX "
      "apart, the same for both eyes (render: the\nfinest, always; view: 0); 0: the finest that fit; "
      "or as in 40dB\n(20dB to 80dB) those that cost so much against the finest, of files\nthat tell "
      "their levels' errors");
  add_value(sub, "--gpu-memory", "MB", o.gpu_memory, positive,
            "Of a streamed SOG: levels, near the eyes the finest, that fit in so\nmany MB; for each view "
            "with --detail, else one choice for all");
  add_axes_option(sub, o);
  auto* antialias = sub.add_flag_callback(
      "--antialias", [&o] { o.antialias = true; },
      "Draw as a model that was trained with anti-aliasing (gsplat's,\nMip-Splatting's); by default "
      "what its file, or the run beside it, says");
  sub.add_flag_callback(
         "--no-antialias", [&o] { o.antialias = false; }, "Draw as one that was not")
      ->excludes(antialias);
  add_value(sub, "--kernel-px2", "S", o.kernel_px2, positive,
            "Variance of the low-pass of projected Gaussians in px^2 (0.3; 0.1\nfor Mip-Splatting's files)");
  add_value(sub, "--appearance", "ID", o.appearance, whole_number,
            "Which of the appearances that a Scaffold-GS model was trained with\n(0)");
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
      "Where the model's x, y and z point in the cameras' world, by Right\nor Left, Up or Down, "
      "Forward or Back, as in rdf, rub (the format's;\nof an spz that does not say: by its "
      "cameras)");
}

void add_place_option(CLI::App& sub, SceneOptions& o) {
  add_value(sub, "--place", "FILE", o.place, CLI::ExistingFile,
            "Other models in the scene's world: JSON, a list of {\"model\": PATH,\n\"matrix\": 16 numbers as "
            "in a node of glTF}");
}

void add_repeat_options(CLI::App& sub, SceneOptions& o) {
  const auto parse = [](const std::string& text) {
    return parse_two("--repeat", text, "copies along x and z as NXxNZ, for one 4x4");
  };
  add_parsed(sub, "--repeat", "NXxNZ", o.repeat, parse, "Copies of the scene along x and z; needs --spacing");
  add_value(sub, "--spacing", "S", o.spacing, positive, "From one copy to the next, in world units");
}

CLI::Option* add_seed_option(CLI::App& sub, SceneOptions& o) {
  return add_value(sub, "--seed", "N", o.seed, whole_number, "Which demo:city (1)");
}

CLI::Option* add_count_option(CLI::App& sub, SceneOptions& o, const char* help) {
  return add_value(sub, "--count", "N", o.count, whole_number, help);
}

void check(const SceneOptions& o) {
  if (o.name != demo_city_name && (o.seed || o.count))
    fail("{} is for {}, and {} is none", o.seed ? "--seed" : "--count", demo_city_name, o.name);
  const char* const of_files = o.lod             ? "--lod"
                               : o.gpu_memory    ? "--gpu-memory"
                               : o.detail        ? "--detail"
                               : o.appearance    ? "--appearance"
                               : !o.axes.empty() ? "--axes"
                                                 : nullptr;
  if (of_files != nullptr && is_built_in(o.name))
    fail("{} is for model files, and {} is none", of_files, o.name);
  if (o.repeat.has_value() != o.spacing.has_value())
    fail("--repeat and --spacing go together: how many copies, and how far apart");
}

}  // namespace binosplat::app
