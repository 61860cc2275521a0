#include "formats/cameras/pose_file.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "base/output_file.h"
#include "base/path_questions.h"
#include "formats/cameras/cameras_file.h"
#include "formats/containers/opened_file.h"

namespace binosplat {

std::filesystem::path pose_path(const std::filesystem::path& model) {
  std::filesystem::path path = model.has_filename() ? model : model.parent_path();
  if (!is_folder(path)) path.replace_extension();
  return path += ".binosplat.json";
}

SavedPose load_pose(const std::filesystem::path& path) {
  SavedPose pose;
  pose.camera = load_cameras(path).front();
  const OpenedFile file(path);
  const JsonValue saved = file.root().at(std::size_t{0});
  const JsonValue up = saved.at("up");
  pose.up = up.vector<3>();
  const double length = glm::length(pose.up);
  if (!(length > 0.0 && std::isfinite(length))) up.fail_here("expected a direction");
  pose.units_per_metre = saved.at("units_per_metre").above_zero();
  pose.ipd = saved.at("ipd_metres").number();
  if (!(pose.ipd >= 0.0)) saved.at("ipd_metres").fail_here("expected zero or more");
  pose.near_plane = saved.at("near").above_zero();
  return pose;
}

std::optional<SavedPose> find_pose(const std::filesystem::path& model) {
  const std::filesystem::path path = pose_path(model);
  if (!is_there(path)) return std::nullopt;
  try {
    return load_pose(path);
  } catch (const Error& error) {
    throw Error(error.code(),
                fmt::format("{}\nThe window saved this file (F9): mend it, or delete it", error.what()));
  }
}

void save_pose(const std::filesystem::path& path, const SavedPose& pose) {
  nlohmann::ordered_json saved = camera_json(pose.camera);
  saved.erase("time");
  saved["up"] = {pose.up.x, pose.up.y, pose.up.z};
  saved["units_per_metre"] = pose.units_per_metre;
  saved["ipd_metres"] = pose.ipd;
  saved["near"] = pose.near_plane;
  write_file(path, nlohmann::ordered_json::array({saved}).dump(2) + "\n");
}

}  // namespace binosplat
