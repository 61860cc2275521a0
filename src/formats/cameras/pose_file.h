#pragma once
// The view that the viewer saves beside a model: MODEL.binosplat.json, a cameras.json with additional keys.

#include <filesystem>
#include <optional>

#include "scene/camera.h"

namespace binosplat {

struct SavedPose {
  Camera camera;                  // between the eyes
  glm::dvec3 up{0.0, -1.0, 0.0};  // up direction of the world
  double units_per_metre = 1.0;   // world units
  double ipd = 0.063;             // m
  double near_plane = 0.2;        // world units
};

/// Returns the path of the saved view, beside a model's file or folder. The path lacks the model's ending, so
/// models that differ only in their endings share a view.
std::filesystem::path pose_path(const std::filesystem::path& model);

/// Reads a view. Throws Error naming the file and the key if it is invalid.
SavedPose load_pose(const std::filesystem::path& path);

/// Reads the file at pose_path(), if it exists. Throws as load_pose does.
std::optional<SavedPose> find_pose(const std::filesystem::path& model);

/// Throws Error if the file cannot be written.
void save_pose(const std::filesystem::path& path, const SavedPose& pose);

}  // namespace binosplat
