#include "app/resume.h"

#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/command.h"
#include "app/content_key.h"
#include "app/run_file.h"
#include "base/log.h"
#include "study/fields.h"

namespace binosplat::app {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

namespace {

constexpr const char* run_name = "render-run.json";

// Where it is drawn and which part of it, and what is believed of files.
constexpr const char* no_matter[] = {"--output", "--shard",      "--resume", "--backend",
                                     "--device", "--max-memory", "--quiet"};

std::string views_key(const std::vector<Shot>& shots) {
  std::vector<Camera> cameras;
  for (const Shot& shot : shots) {
    for (const Eye& eye : shot.eyes) {
      cameras.push_back(eye.camera);
      cameras.back().name = fmt::format("{} {} {}", shot.name, shot.stem, eye.side);
    }
  }
  return content_key(cameras);
}

}  // namespace

std::vector<std::string> options_given(const CLI::App& sub) {
  std::vector<std::string> given;
  for (const CLI::Option* option : sub.get_options()) {
    const bool matters = std::none_of(std::begin(no_matter), std::end(no_matter),
                                      [&](const char* name) { return option->check_name(name); });
    if (matters && option->count() > 0)
      given.push_back(fmt::format("{} {}", option->get_name(), fmt::join(option->results(), " ")));
  }
  return given;
}

ordered_json identity_of(const RenderOptions& o, const CameraList& list, double near_plane,
                         const std::vector<Shot>& shots) {
  // The list itself: of it --transmittance depth measures views that are not drawn.
  ordered_json run = study::object("format", "binosplat render", "program", BINOSPLAT_VERSION, "options",
                                   o.given, "cameras", content_key(list.cameras), "views", views_key(shots),
                                   "near", near_plane, "units_per_metre", shots[0].units_per_metre);
  if (!is_built_in(o.scene.name)) run["model"] = content_key(fs::path(o.scene.name));
  if (!o.drawing.calibration.empty()) run["calibration"] = file_key(o.drawing.calibration);
  // As save_json() leaves it: names may be in any encoding.
  return ordered_json::parse(run.dump(-1, ' ', false, ordered_json::error_handler_t::replace));
}

void leave_out_drawn(const OutputPlan& plan, const ordered_json& run, std::vector<Shot>& shots) {
  const fs::path file = plan.folder / run_name;
  if (fs::exists(file)) {
    check_same_run(file, run, "pictures");
  } else {
    for (const Shot& shot : shots) {
      for (const std::string& picture : files_of(plan, shot)) {
        if (fs::exists(picture))
          fail(
              "{}: nothing says how it was drawn, so that --resume cannot go on from it. Name another folder "
              "with -o, or remove it",
              picture);
      }
    }
    save_json(file, run);
  }
  const std::size_t all = shots.size();
  const std::size_t there = std::erase_if(shots, [&](const Shot& shot) {
    const std::vector<std::string> files = files_of(plan, shot);
    return std::all_of(files.begin(), files.end(), [](const std::string& name) { return fs::exists(name); });
  });
  log_info("{} of {} views are in {} already", there, all, plan.folder.string());
}

void forget_run(const OutputPlan& plan) {
  std::error_code ignored;
  if (!plan.folder.empty()) fs::remove(plan.folder / run_name, ignored);
}

}  // namespace binosplat::app
