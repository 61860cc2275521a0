#include "app/render/resume.h"

#include <fcntl.h>
#include <fmt/ranges.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/command.h"
#include "app/models/placed.h"
#include "base/inputs.h"
#include "base/log.h"
#include "formats/cameras/pose_file.h"
#include "formats/containers/complete_files.h"
#include "formats/models/files_of_model.h"
#include "lab/fields.h"

namespace binosplat::app {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

namespace {

constexpr const char* render_run_name = "render-run.json";

}  // namespace

void protect_scene(const SceneOptions& scene) {
  if (!is_built_in(scene.name)) {
    for (const fs::path& file : files_of_model(scene.name)) protect_input(file);
    protect_input(pose_path(scene.name));
  }
  if (!scene.place.empty()) protect_placed(scene.place);
}

ordered_json identity_of(const std::vector<std::string>& given) {
  ordered_json run = lab::object("program", BINOSPLAT_VERSION, "options", given);
  for (const fs::path& file : noted_inputs()) {
    run[file.string()] = fmt::format("{} bytes of time {}", fs::file_size(file),
                                     fs::last_write_time(file).time_since_epoch().count());
  }
  // As save_json() would write it, which replaces bytes of names that are not UTF-8.
  return ordered_json::parse(run.dump(-1, ' ', false, ordered_json::error_handler_t::replace));
}

FolderLock::FolderLock(const fs::path& run_file)
    : there_(nearest_existing_folder(run_file.parent_path())), file_(fs::path(run_file) += ".lock") {
  const std::string folder = run_file.parent_path().string();
  std::error_code ignored;
  fs::create_directories(folder, ignored);
  struct stat locked = {}, found = {};
  do {
    if (handle_ >= 0) close(handle_);
    handle_ = open(file_.path().c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (handle_ < 0) fail("cannot write {}: {}", file_.path().string(), std::strerror(errno));
    if (flock(handle_, LOCK_EX | LOCK_NB) != 0) {
      char id[16] = {};
      if (read(handle_, id, sizeof id - 1) <= 0) id[0] = '?';
      close(handle_);
      fail("{}: process {} is writing there: wait until it ends, or name another folder with -o", folder, id);
    }
    // Another process may have removed the file after it was opened here.
  } while (fstat(handle_, &locked) == 0 &&
           (stat(file_.path().c_str(), &found) != 0 || found.st_ino != locked.st_ino));
  const std::string id = std::to_string(getpid());
  if (ftruncate(handle_, 0) != 0 || write(handle_, id.data(), id.size()) < 0)
    log_warning("cannot write {}: {}", file_.path().string(), std::strerror(errno));
}

FolderLock::~FolderLock() {
  std::error_code ignored;
  fs::remove(file_.path(), ignored);
  close(handle_);
  for (fs::path folder = file_.path().parent_path(); folder != there_ && fs::remove(folder, ignored);)
    folder = folder.parent_path();
}

void remove_drawn_shots(const fs::path& folder, const ordered_json& run, std::vector<Shot>& shots) {
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
        std::ranges::all_of(shot.files, [](const PictureFile& picture) { return is_complete(picture.name); });
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

void forget_run(const fs::path& folder) {
  std::error_code ignored;
  if (!folder.empty()) fs::remove(folder / render_run_name, ignored);
}

}  // namespace binosplat::app
