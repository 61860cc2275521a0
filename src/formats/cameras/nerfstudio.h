#pragma once
// Cameras in the world of nerfstudio's training: its viewer's camera_path.json, `ns-export cameras`' poses.

#include <filesystem>
#include <vector>

#include "formats/containers/json_file.h"
#include "scene/camera.h"

namespace binosplat {

/// Returns whether a JSON file is a path: an object with camera_path (frames) or keyframes.
bool is_camera_path(const nlohmann::json& root);

/// Reads the frames of a path as cameras named 00000 and so on; times come from `seconds` or else from `fps`.
/// If the path has no frames, reads its keyframes, named key_000 and so on; times come from their
/// transitions. The pose is camera_to_world, or a keyframe's matrix: 16 numbers, with OpenGL's axes. `fov` is
/// vertical, in degrees. Frames are row-major. Keyframes as lists are row-major; keyframes in quotes, from
/// older viewers, are column-major. render_width and render_height are the pictures' size. Throws Error
/// naming the file and the key for paths of fisheyes and panoramas, and for missing or wrong values.
std::vector<Camera> load_camera_path(const std::filesystem::path& path, const nlohmann::json& json);

bool is_pose_list(const nlohmann::json& root);

/// Size, px, of pictures for poses without lenses if the photos are missing.
constexpr int pose_width = 1280, pose_height = 720;

/// Reads a list of poses in file order, camera-to-world with OpenGL's axes; a camera's name is its file_path.
/// The file has no lenses: pictures have the size of their photos, or pose_width x pose_height, and a
/// vertical field of view of `fov_degrees`. Throws Error naming the file and the key for missing or wrong
/// values.
std::vector<Camera> load_pose_list(const std::filesystem::path& path, const nlohmann::json& json,
                                   double fov_degrees);

}  // namespace binosplat
