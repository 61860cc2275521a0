// binosplat levels: writes a model at several levels of detail, in files that can be read separately.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <utility>

#include "app/bench/report.h"
#include "app/command.h"
#include "app/models/load_scene.h"
#include "app/models/model_files.h"
#include "app/open_context.h"
#include "app/options/checks.h"
#include "app/render/resume.h"
#include "app/render/shots.h"
#include "base/error.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "base/output_file.h"
#include "compact/joint_loss.h"
#include "compact/level_errors.h"
#include "compact/level_errors_json.h"
#include "compact/streamed_sog_writer.h"
#include "formats/cameras/cameras_file.h"
#include "formats/containers/complete_files.h"
#include "formats/containers/content.h"
#include "lab/results.h"
#include "scene/axes.h"

namespace binosplat::app {

namespace {

namespace fs = std::filesystem;

constexpr const char* levels_run_name = "levels-run.json";

/// The output folder. Caches which files are complete, because several threads test the same ones repeatedly.
class Folder {
 public:
  explicit Folder(fs::path folder) : folder_(std::move(folder)) {}

  /// Whether a file is complete; logs incomplete ones.
  bool has(const std::string& name) {
    const std::lock_guard lock(mutex_);
    const auto [at, is_new] = has_.try_emplace(name, false);
    if (is_new && fs::exists(folder_ / name)) {
      at->second = is_complete(name);
      if (!at->second) log_info("{} is incomplete and is written again", (folder_ / name).string());
    }
    return at->second;
  }

  std::string read(const std::string& name) const {
    return std::string(as_text(MappedFile(folder_ / name).bytes()));
  }

  void write(const std::string& name, std::span<const std::byte> bytes) {
    write_file(folder_ / name, as_text(bytes));
    const std::lock_guard lock(mutex_);
    has_[name] = true;
  }

 private:
  bool is_complete(const std::string& name) const {
    if (name.ends_with("meta.json")) return is_whole_sog(folder_ / name);
    return binosplat::is_complete(folder_ / name) &&
           (!name.starts_with("joint_") || all_drawn(name, read(name)));
  }

  fs::path folder_;
  std::mutex mutex_;
  std::map<std::string, bool> has_;
};

/// Whether the folder holds an earlier run of the same identity. Throws Error if it holds anything else.
bool has_run(const Options& o, const nlohmann::ordered_json& run) {
  const fs::path folder = o.output, file = folder / levels_run_name;
  check_output(file);
  check_output(folder / "lod-meta.json");
  // Looks for other files before the run file. A run that starts meanwhile writes its run file first (under a
  // name that also begins with levels_run_name), so its files are not mistaken for others.
  std::error_code none;
  const bool others =
      std::any_of(fs::directory_iterator(folder, none), {}, [](const fs::directory_entry& entry) {
        return !entry.path().filename().string().starts_with(levels_run_name);
      });
  if (fs::exists(file)) {
    check_same_run(file, run, "levels");
    return true;
  }
  if (others) fail("-o {}: the folder has other files; name another, or an empty one", o.output);
  return false;
}

/// Writes the model's cameras (in the world) beside the levels, for the same views. Keeps a complete file.
void write_cameras(const Options& o) {
  const fs::path file = fs::path(o.output) / "cameras.json";
  if (is_complete(file)) return;
  const CameraList list = listed_cameras(o.scene, {});
  if (!list.hints.unusable.empty())
    log_warning("{}; no cameras are left beside the levels", list.hints.unusable);
  auto json = nlohmann::ordered_json::array();
  for (const Camera& camera : list.cameras) {
    json.push_back(camera_json(camera));
    if (!camera.time) json.back().erase("time");
  }
  if (!list.cameras.empty()) save_json(file, json);
}

ExitCode levels(const Options& o) {
  check(o.scene);
  protect_scene(o.scene);
  const nlohmann::ordered_json run = identity_of(o.given);
  const bool again = has_run(o, run);
  Model model = load_scene(o.scene);
  refuse_scaffold(model, o.scene.name);
  if (o.camera.near_plane) model.near_plane = o.camera.near_plane;
  bring_into_axes(model, row_of(ModelFormat::sog).axes);
  const auto context = open_context(o.context);
  const FolderLock lock(fs::path(o.output) / levels_run_name);
  claim_run(fs::path(o.output) / levels_run_name, run, "levels");
  Folder folder(o.output);
  LevelSettings settings;
  settings.levels = o.levels.value_or(settings.levels);
  settings.chunk = o.chunk.value_or(settings.chunk);
  std::ptrdiff_t undrawn = 0;
  const LevelsWritten written = write_streamed_sog(
      model, settings,
      {[&](const std::string& name) { return folder.has(name); },
       [&](const std::string& name) { return folder.read(name); },
       [&](const std::string& name, std::span<const std::byte> bytes) { folder.write(name, bytes); }},
      {[&](std::span<const std::vector<Model>> levels_of_chunks) {
         return compact::level_errors(*context, levels_of_chunks);
       },
       [&](std::span<const std::vector<Model>> levels_of_chunks, std::span<const LevelErrors> errors,
           int pictures) {
         std::vector<JointLoss> losses = compact::joint_losses(*context, levels_of_chunks, errors, pictures);
         undrawn += std::ranges::count(losses, false, &JointLoss::drawn);
         return losses;
       }});
  if (undrawn > 0)
    log_warning(
        "out of memory for {} of the pictures that measure the loss of many chunks together. Levels are "
        "chosen by this loss, so --detail and --quality may lose more or less than they report. Run it again "
        "with more memory to draw these pictures",
        undrawn);
  for (const std::string& loss : written.losses) log_warning("{}", loss);
  if (again) log_info("{} of {} SOGs were in {} already", written.kept, written.files, o.output);
  write_cameras(o);
  std::vector<lab::Row> rows;
  for (const std::size_t gaussians : written.gaussians)
    rows.push_back(lab::object("level", rows.size(), "gaussians", gaussians));
  print_table(rows, {"level", "gaussians"});
  fmt::print("\n{}\n", (fs::path(o.output) / "lod-meta.json").string());
  return ExitCode::done;
}

}  // namespace

void add_levels(CLI::App& program, Command& command) {
  add_command(program, command,
              {"levels", in::levels, "Write a model at several levels of detail (streamed SOG)",
               "To resume an interrupted run, start it again with the same options.\n"
               "Examples:\n"
               "  binosplat levels garden.ply -o garden\n"
               "  binosplat render garden --detail 40dB"},
              levels);
}

}  // namespace binosplat::app
