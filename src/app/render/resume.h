#pragma once
// Resumed runs: they keep the results of an earlier run with the same options and inputs.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/options/options.h"
#include "app/render/shots.h"
#include "base/output_file.h"

namespace binosplat::app {

/// Records the files of a scene's model and its saved pose as inputs (base/inputs.h).
void protect_scene(const SceneOptions& scene);

/// The values that distinguish runs: program, options, and the size and time of each input recorded so far.
nlohmann::ordered_json identity_of(const std::vector<std::string>& given);

/// Keeps other processes out of a folder that this one writes, by a file with this process's id. The system
/// unlocks the file of a process that has ended.
class FolderLock {
 public:
  /// Locks the folder of `run_file`, and makes it if necessary. Throws Error if a process has locked it.
  explicit FolderLock(const std::filesystem::path& run_file);
  /// Removes the file, and the folders that the constructor made, if they are empty.
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  std::filesystem::path there_;  // the nearest folder that existed before
  UnfinishedFile file_;
  int handle_ = -1;
};

/// Removes the shots whose files are all complete in the folder, and logs their number. The first run writes
/// a file that identifies it beside the pictures. Throws Error if the file describes another run, or if there
/// are pictures but no file of a run.
void remove_drawn_shots(const std::filesystem::path& folder, const nlohmann::ordered_json& run,
                        std::vector<Shot>& shots);

/// For runs that draw all views: removes the file that identifies earlier pictures in the folder.
void forget_run(const std::filesystem::path& folder);

/// Call it after the last shot. Throws Error if another run has started to draw into the folder meanwhile.
/// `run` is as for remove_drawn_shots(), or none after forget_run().
void check_alone(const std::filesystem::path& folder, const std::optional<nlohmann::ordered_json>& run);

}  // namespace binosplat::app
