#include "app/resume.h"

#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/bench_plan.h"
#include "app/command.h"
#include "app/content_key.h"
#include "app/placed.h"
#include "base/log.h"
#include "base/output_file.h"
#include "formats/whole.h"
#include "lab/fields.h"

namespace binosplat::app {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

namespace {

constexpr const char* render_run_name = "render-run.json";

// Options that affect no picture, but only where, how fast and in which shard pictures are drawn.
constexpr const char* no_matter[] = {"--output",     "--shard", "--resume",    "--backend",        "--device",
                                     "--max-memory", "--quiet", "--png-level", "--exr-compression"};

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

fs::path steps_of(const fs::path& result) { return fs::path(result) += ".unfinished"; }

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
  // All cameras, because --transmittance depth also measures views that are not drawn.
  ordered_json run = lab::object("format", "binosplat render", "program", BINOSPLAT_VERSION, "options",
                                 o.given, "cameras", content_key(list.cameras), "views", views_key(shots),
                                 "near", near_plane, "units_per_metre", shots[0].units_per_metre);
  if (!is_built_in(o.scene.name)) run["model"] = content_key(fs::path(o.scene.name));
  if (!o.scene.place.empty()) run["place"] = placed_key(o.scene.place);
  if (!o.drawing.calibration.empty()) run["calibration"] = file_key(o.drawing.calibration);
  // As save_json() would write it, which replaces bytes of names that are not UTF-8.
  return ordered_json::parse(run.dump(-1, ' ', false, ordered_json::error_handler_t::replace));
}

void leave_out_drawn(const fs::path& folder, const ordered_json& run, std::vector<Shot>& shots) {
  const fs::path file = folder / render_run_name;
  const auto is_there = [](const PictureFile& picture) { return fs::exists(picture.name); };
  for (const Shot& shot : shots) {
    // Looks for pictures before the run's file. A run that starts meanwhile writes its file first, so its
    // pictures are not mistaken for pictures without a run.
    const auto picture = std::ranges::find_if(shot.files, is_there);
    if (picture == shot.files.end()) continue;
    if (fs::exists(file)) break;
    fail(
        "{}: it belongs to no known run, so --resume cannot continue it. Name another folder with -o, or "
        "remove it",
        picture->name);
  }
  claim_run(file, run, "pictures");
  const std::size_t all = shots.size();
  std::size_t cut = 0;
  const std::size_t there = std::erase_if(shots, [&](const Shot& shot) {
    if (!std::ranges::all_of(shot.files, is_there)) return false;
    const bool whole =
        std::ranges::all_of(shot.files, [](const PictureFile& picture) { return is_whole(picture.name); });
    cut += whole ? 0 : 1;
    return whole;
  });
  log_info("{} of {} views are in {} already", there, all, folder.string());
  if (cut > 0)
    log_warning("{} of the views there {} cut short, and drawn again", cut, cut == 1 ? "is" : "are");
}

void check_alone(const fs::path& folder, const std::optional<ordered_json>& run) {
  if (folder.empty()) return;
  const fs::path file = folder / render_run_name;
  const bool there = fs::exists(file);
  if (there && run) return check_same_run(file, *run, "pictures");
  if (there || run)
    fail(
        "{}: another run has drawn into the folder meanwhile, and its pictures may be among these: draw them "
        "again, in a folder of their own",
        folder.string());
}

lab::StepCache cache_steps(const fs::path& result, const MeasuredOptions& options, const PhotoSource& photos,
                           const CameraList& list, const gl::Context& context) {
  const std::string run =
      json_text(lab::object("program", BINOSPLAT_VERSION, "options", options.given, "scene",
                            scene_identity(options, {options.scene.name, options.scene, list, photos}),
                            "device", lab::device_text(context)));
  return [folder = steps_of(result), run](const std::string& step, const auto& measure) {
    const fs::path file = folder / (text_key(run + step) + ".json");
    if (is_whole(file)) return load_json(file);
    ordered_json measured = measure();
    OutputFile kept(file);
    kept.write(json_text(measured));
    kept.commit(false);
    return measured;
  };
}

void forget_steps(const fs::path& result) {
  std::error_code ignored;
  fs::remove_all(steps_of(result), ignored);
}

void forget_run(const fs::path& folder) {
  std::error_code ignored;
  if (!folder.empty()) fs::remove(folder / render_run_name, ignored);
}

}  // namespace binosplat::app
