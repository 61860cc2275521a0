#pragma once
// Cameras that nerfstudio writes in the world of its training: paths of its viewer (camera_path.json), and
// poses of `ns-export cameras`.

#include <filesystem>
#include <vector>

#include "formats/json_file.h"
#include "scene/camera.h"

namespace binosplat {

/// Returns whether a JSON file is a path: an object with camera_path (frames) or keyframes.
bool is_camera_path(const nlohmann::json& root);

/// Reads the frames of a path, named 00000 and so on, with times from `seconds` or else `fps`. A path without
/// frames has keyframes, named key_000 and so on, with times from their transitions. Each has a
/// camera_to_world (a keyframe: matrix) of 16 numbers, with OpenGL's axes, and a vertical fov in degrees.
/// Frames are row-major. Keyframes are row-major as lists, and column-major in quotes, as older viewers wrote
/// them. render_width and render_height are the pictures' size. Throws Error naming the file and the key for
/// paths of fisheyes and panoramas, and for missing or wrong values.
std::vector<Camera> load_camera_path(const std::filesystem::path& path, const nlohmann::json& json);

/// Returns whether a JSON file has only poses: a list of objects with file_path and transform.
bool is_pose_list(const nlohmann::json& root);

/// Size of pictures for poses without lenses, if their photos are missing, px.
constexpr int pose_width = 1280, pose_height = 720;

/// Reads such poses in file order, camera-to-world with OpenGL's axes; a camera's name is its file_path. The
/// file has no lenses: pictures have the size of their photos, or pose_width x pose_height, and a vertical
/// field of view of `fov_degrees`. Throws Error naming the file and the key for missing or wrong values.
std::vector<Camera> load_pose_list(const std::filesystem::path& path, const nlohmann::json& json,
                                   double fov_degrees);

}  // namespace binosplat
