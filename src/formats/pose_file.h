#pragma once
// How a model was looked at, kept beside it: MODEL.binosplat.json, a cameras.json of one camera with some
// keys more.

#include <filesystem>
#include <optional>

#include "scene/camera.h"

namespace binosplat {

struct SavedPose {
  Camera camera;                  // between the eyes
  glm::dvec3 up{0.0, -1.0, 0.0};  // the world's
  double units_per_metre = 1.0;   // world units
  double ipd = 0.063;             // m
  double near_plane = 0.2;        // world units
};

/// Beside a model's file or folder, without that file's ending: models of one name share it.
std::filesystem::path pose_path(const std::filesystem::path& model);

/// Throws Error naming the file and the key for what cannot be understood.
SavedPose load_pose(const std::filesystem::path& path);

/// What lies at pose_path, if anything does. Throws as load_pose does.
std::optional<SavedPose> find_pose(const std::filesystem::path& model);

/// Throws Error where it cannot be written.
void save_pose(const std::filesystem::path& path, const SavedPose& pose);

}  // namespace binosplat
