#include "app/option_conflicts.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <vector>

#include "base/error.h"

namespace binosplat::app {

namespace {

const struct {
  const char* option;
  std::vector<const char*> others;
  const char* why;
} apart[] = {
    {"--eye", {"--orbit", "--cameras", "--view"}, "it makes a camera of its own"},
    {"--orbit", {"--cameras", "--view"}, "it makes cameras of its own"},
    {"--frame", {"--cameras", "--view", "--eye", "--path", "--tour"}, "it makes a camera of its own"},
    {"--tour",
     {"--view", "--path", "--eye", "--orbit", "--frames"},
     "it goes through all cameras of the scene or of --cameras, each frame drawn once"},
    {"--tour", {"--photos"}, "there are no photos between the cameras"},
    {"--path",
     {"--cameras", "--view", "--eye", "--orbit", "--frames"},
     "it names its own cameras, each frame drawn once"},
    {"--view", {"--views", "--test"}, "it names the views"},
    {"--keys", {"--seconds"}, "it draws the keys alone"},
    {"--cant", {"--convergence"}, "canted eyes have no common picture plane to shift"},
    {"--mono", {"--only"}, "it draws the camera itself, and --only an eye beside it"},
    {"--mono", {"--ipd", "--convergence", "--cant"}, "it has no rig"},
    {"--lod", {"--gpu-memory", "--detail"}, "both choose the levels of detail"},
    {"--detail", {"--repeat", "--place"}, "copies and placed models have one level of detail for all"},
    {"--calibration", {"--quality"}, "both choose the tolerance"},
    {"--calibration", {"--reference-until"}, "the reference uses no calibration"},
    {"--foveate",
     {"--quality", "--calibration"},
     "its tolerance is for whole pictures; give --tolerance for the context"},
    {"--foveate", {"--reference-until"}, "the reference draws whole pictures"},
    {"--foveate",
     {"--detail"},
     "levels of detail are chosen for whole pictures; --lod and --gpu-memory choose them once"},
    {"--resume", {"--json", "--photos"}, "it skips existing pictures, and these report all"},
    {"--vr180",
     {"--fov",         "--convergence", "--cant",      "--order",           "--projection", "--tiles",
      "--threshold",   "--tolerance",   "--quality",   "--transmittance",   "--show",       "--detail",
      "--calibration", "--photos",      "--precision", "--reference-until", "--exr-depth",  "--only",
      "--foveate",     "--preset"},
     "it draws both eyes, or --mono, exactly and along rays of its own"}};

const struct {
  const char *option, *other, *why;
} needed[] = {{"--eye", "--at", "what the camera looks at"},
              {"--at", "--eye", "where the camera is"},
              {"--keys", "--path", "the file of the keys"}};

}  // namespace

void check_conflicts(const CLI::App& sub) {
  const auto is_given = [&](const char* name) {
    const CLI::Option* const option = sub.get_option_no_throw(name);
    return option != nullptr && option->count() > 0;
  };
  for (const auto& [option, others, why] : apart) {
    for (const char* other : others) {
      if (is_given(option) && is_given(other))
        fail("{} with {}: {}: leave one of them out", option, other, why);
    }
  }
  for (const auto& [option, other, why] : needed) {
    if (is_given(option) && !is_given(other)) fail("{} needs {}: {}", option, other, why);
  }
}

}  // namespace binosplat::app
