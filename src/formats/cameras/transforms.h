#pragma once
// Reads transforms.json, the cameras of instant-ngp, nerfstudio and Blender's NeRF scenes.

#include <filesystem>
#include <vector>

#include "formats/containers/json_file.h"
#include "scene/camera.h"

namespace binosplat {

bool is_transforms(const nlohmann::json& root);

/// The transform p' = rotation p + shift: three rows of four numbers, or four, of which the last is ignored.
struct RigidTransform {
  glm::dmat3 rotation{1.0};
  glm::dvec3 shift{0.0};
};

/// Reads the rows of a transform. Throws Error for other rows, and if the columns are no rotation. Replaces
/// those of a camera's `pose` by the nearest rotation (formats/cameras/lens.h).
RigidTransform read_rows(const JsonValue& rows, bool pose = false);

/// Sets a camera's pose from a camera-to-world pose with OpenGL's axes: y up and z backwards.
void place_as_opengl(Camera& camera, const RigidTransform& pose);

/// Reads the frames in file order; a camera's name is its file_path. Poses are camera-to-world with OpenGL's
/// axes, as stored: nerfstudio's applied_transform stays applied. If a frame lacks w, h, fl_x, fl_y, cx or
/// cy, the file's value applies. Without fl_x, camera_angle_x or x_fov gives the focal length; without w and
/// h, the picture gives the size. LensReport (formats/cameras/distortion.h) defines how lenses are drawn.
/// Throws Error naming the frame and the key for missing or wrong values.
std::vector<Camera> load_transforms(const std::filesystem::path& path, const nlohmann::json& json);

}  // namespace binosplat
