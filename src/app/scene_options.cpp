#include "app/scene_options.h"

#include <cctype>
#include <cmath>

#include "app/option_checks.h"
#include "base/error.h"
#include "base/numbers.h"
#include "demo/city.h"
#include "scene/axes.h"

namespace binosplat::app {

DetailRequest parse_detail(const std::string& text) {
  std::string_view rest = text;
  const std::optional<double> number = take_real(rest);
  std::string unit(rest);
  for (char& c : unit) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (number && std::isfinite(*number) && unit.empty() && *number >= 0.0) return {.apart_px = *number};
  if (number && unit == "db" && *number >= 20.0 && *number <= 80.0) return {.db = *number};
  fail("--detail {}: expected pixels as in 5, or decibels from 20 to 80 as in 40dB", text);
}

void add_scene_options(CLI::App& sub, SceneOptions& o) {
  sub.add_option("SCENE", o.name,
                 "A model's file or folder, of the formats\n" + names_of_formats() +
                     ";\nor one that is built in: demo:room, a room, or demo:city, streets\nof any size")
      ->required();
  sub.option_defaults()->group("Scene");
  add_lod_option(sub, o, "Level of detail of a streamed SOG, 0 the finest (the finest that\nis there)");
  sub.add_option_function<std::string>(
         "--detail", [&o](const std::string& text) { o.detail = parse_detail(text); },
         "Of a streamed SOG instead: for each view levels whose Gaussians are\nseen no farther than PX "
         "apart, the same for both eyes (render: the\nfinest, always; view: 0); 0: the finest that fit; or "
         "as in 40dB\n(20dB to 80dB) those that cost so much against the finest, of files\nthat tell their "
         "levels' errors")
      ->type_name("PX|DB");
  sub.add_option(
         "--gpu-memory", o.gpu_memory,
         "Of a streamed SOG: levels, near the eyes the finest, that fit in so\nmany MB; for each view "
         "with --detail, else one choice for all")
      ->type_name("MB")
      ->check(positive);
  add_axes_option(sub, o);
  auto* antialias = sub.add_flag_callback(
      "--antialias", [&o] { o.antialias = true; },
      "Draw as a model that was trained with anti-aliasing (gsplat's,\nMip-Splatting's); by default "
      "what its file, or the run beside it, says");
  sub.add_flag_callback(
         "--no-antialias", [&o] { o.antialias = false; }, "Draw as one that was not")
      ->excludes(antialias);
  sub.add_option(
         "--kernel-px2", o.kernel_px2,
         "Variance of the low-pass of projected Gaussians in px^2 (0.3; 0.1\nfor Mip-Splatting's files)")
      ->type_name("S")
      ->check(positive);
  sub.add_option("--appearance", o.appearance,
                 "Which of the appearances that a Scaffold-GS model was trained with\n(0)")
      ->type_name("ID")
      ->check(whole_number);
  add_seed_option(sub, o);
  add_count_option(sub, o, "Gaussians of demo:city, 10000 to 100000000 (1000000)");
  add_repeat_options(sub, o);
}

CLI::Option* add_lod_option(CLI::App& sub, SceneOptions& o, const char* help) {
  return sub.add_option("--lod", o.lod, help)->type_name("N")->check(range(0, 100));
}

CLI::Option* add_axes_option(CLI::App& sub, SceneOptions& o) {
  return sub
      .add_option_function<std::string>(
          "--axes",
          [&o](const std::string& text) {
            for (const char c : text)
              o.axes += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
            world_from_axes(o.axes);
          },
          "Where the model's x, y and z point in the cameras' world, by Right\nor Left, Up or Down, Forward "
          "or Back, as in rdf, rub (the format's;\nof an spz that does not say: by its cameras)")
      ->type_name("XYZ");
}

void add_repeat_options(CLI::App& sub, SceneOptions& o) {
  sub.add_option_function<std::string>(
         "--repeat",
         [&o](const std::string& text) {
           o.repeat = parse_two("--repeat", text, "copies along x and z as NXxNZ, for one 4x4");
         },
         "Copies of the scene along x and z; needs --spacing")
      ->type_name("NXxNZ");
  sub.add_option("--spacing", o.spacing, "From one copy to the next, in world units")
      ->type_name("S")
      ->check(positive);
}

CLI::Option* add_seed_option(CLI::App& sub, SceneOptions& o) {
  return sub.add_option("--seed", o.seed, "Which demo:city (1)")->type_name("N")->check(whole_number);
}

CLI::Option* add_count_option(CLI::App& sub, SceneOptions& o, const char* help) {
  return sub.add_option("--count", o.count, help)->type_name("N")->check(whole_number);
}

void check(const SceneOptions& o) {
  if (o.name != demo_city_name && (o.seed || o.count))
    fail("{} is for {}, and {} is none", o.seed ? "--seed" : "--count", demo_city_name, o.name);
  if (o.lod && (o.gpu_memory || o.detail)) {
    fail("--lod and {} both choose the levels of detail: leave one of them out",
         o.gpu_memory ? "--gpu-memory" : "--detail");
  }
  if (o.detail && o.repeat) fail("--detail and --repeat: copies have one level of detail for all");
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
