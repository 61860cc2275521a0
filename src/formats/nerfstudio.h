#pragma once
// Cameras that nerfstudio writes in the world of its training: the paths of its viewer (camera_path.json),
// and the poses of `ns-export cameras`.

#include <filesystem>
#include <vector>

#include "formats/json_file.h"
#include "scene/camera.h"

namespace binosplat {

/// Whether a JSON file is a path: an object with camera_path, its frames, or keyframes, which they go
/// through.
bool is_camera_path(const nlohmann::json& root);

/// The frames of a path, called 00000 and so on, with their times by `seconds`, or else `fps`. Of
/// a path without frames the keyframes, key_000 and so on, with times as their transitions take. Each has a
/// camera_to_world (of a keyframe: matrix) of 16 numbers, with OpenGL's axes, and a vertical fov in degrees.
/// Frames are row-major; keyframes are so as lists, and column-major in quotes, as older viewers wrote them.
/// render_width and render_height are the pictures' size. Throws Error naming the file and the key
/// for paths of fisheyes and panoramas and all that is missing or wrong.
std::vector<Camera> load_camera_path(const std::filesystem::path& path, const nlohmann::json& json);

/// Whether a JSON file has poses alone: a list of objects with file_path and transform.
bool is_pose_list(const nlohmann::json& root);

/// What pictures of poses alone are of where their photos are not found, px.
constexpr int pose_width = 1280, pose_height = 720;

/// Reads such poses in file order, camera-to-world with OpenGL's axes; a camera's name is its file_path. The
/// file says nothing of lenses: pictures have the size of their photos, or pose_width x pose_height, and
/// are `fov_degrees` high. Throws Error naming the file and the key for what is missing or wrong.
std::vector<Camera> load_pose_list(const std::filesystem::path& path, const nlohmann::json& json,
                                   double fov_degrees);

}  // namespace binosplat
