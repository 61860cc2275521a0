#include "app/headset_options.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <utility>

#include "app/option_checks.h"
#include "base/error.h"

namespace binosplat::app {

namespace {

// What a headset has of its own, and what only windows have.
constexpr const char* of_windows[] = {"--size", "--layout", "--ipd", "--convergence", "--cant",
                                      "--show", "--split",  "--fov", "--output"};
// What only studies choose; a headset's pictures are drawn by the library.
constexpr const char* of_studies[] = {"--tiles", "--tile", "--shader-dir"};
constexpr const char* of_headsets[] = {"--scale", "--frame-budget", "--no-mirror", "--record", "--foveate"};

bool is_given(const CLI::App& sub, const char* name) {
  const CLI::Option* const option = sub.get_option_no_throw(name);
  return option != nullptr && option->count() > 0;
}

}  // namespace

void add_headset_options(CLI::App& sub, HeadsetOptions& o) {
  sub.option_defaults()->group("Headset");
  sub.add_flag("--xr", o.xr,
               "In the headset of an OpenXR runtime; sticks walk and turn, grips hold the\nworld");
  sub.add_option("--scale", o.scale, "Of both sides of the pictures that the runtime recommends (1)")
      ->type_name("FACTOR")
      ->check(between(0.1, 4.0, "a factor from 0.1 to 4"));
  sub.add_option_function<std::string>(
         "--frame-budget",
         [&o](const std::string& text) {
           double ms = 0.0;
           const bool good =
               text == "auto" || (CLI::detail::lexical_cast(text, ms) && ms > 0.0 && ms <= 1000.0);
           if (!good) fail("--frame-budget {}: expected milliseconds above 0, at most 1000, or auto", text);
           o.budget_ms = ms;
         },
         "Quality, then size, as a frame's time allows: less where frames take\nlonger; auto: four fifths of "
         "the time that the runtime has for one")
      ->type_name("MS|auto");
  sub.add_option(
         "--record", o.record_s,
         "Record the first S seconds as `profile` does; F8 in the window that\nmirrors records ten more")
      ->type_name("S")
      ->check(between(1e-3, 3600.0, "seconds above zero, at most 3600"));
  sub.add_flag_callback(
      "--no-mirror", [&o] { o.mirror = false; }, "No window that shows what the left eye sees");
}

void check(const HeadsetOptions& o, const CLI::App& sub) {
  if (!o.xr) {
    for (const char* name : of_headsets) {
      if (is_given(sub, name)) fail("{} is for a headset: add --xr, or leave it out", name);
    }
    return;
  }
  for (const char* name : of_windows) {
    if (is_given(sub, name)) fail("{} with --xr: leave it out, a headset decides that itself", name);
  }
  for (const char* name : of_studies) {
    if (is_given(sub, name))
      fail("{} with --xr: leave it out, a headset's pictures have exact tiles of 16 px", name);
  }
  const std::pair<const char*, const char*> beside_a_budget[] = {
      {"--foveate", "a quality is one for whole pictures: choose one of them"},
      {"--quality", "choose one, the budget chooses the quality"},
      {"--tolerance", "choose one, the budget chooses what is left out"}};
  for (const auto& [name, why] : beside_a_budget) {
    if (o.budget_ms && is_given(sub, name)) fail("--frame-budget with {}: {}", name, why);
  }
}

}  // namespace binosplat::app
