#pragma once
// Cameras as instant-ngp, nerfstudio and Blender's NeRF scenes have them: transforms.json.

#include <filesystem>
#include <vector>

#include "formats/json_file.h"
#include "scene/camera.h"

namespace binosplat {

/// Whether a JSON file is one.
bool is_transforms(const nlohmann::json& root);

/// Three rows of four numbers, or four rows of which the last is not read: p' = rotation p + shift.
struct RigidTransform {
  glm::dmat3 rotation{1.0};
  glm::dvec3 shift{0.0};
};

/// Throws Error for other rows, and for what is no rotation.
RigidTransform read_rows(const JsonValue& rows);

/// Turns and moves a camera to a camera-to-world pose with OpenGL's axes, where y is up and z backwards.
void place_as_opengl(Camera& camera, const RigidTransform& pose);

/// Reads the frames in file order; a camera's name is its file_path. Poses are camera-to-world with OpenGL's
/// axes, as stored: what nerfstudio applied to them (applied_transform) stays. The size, fl_x, fl_y, cx and
/// cy are the frame's or the file's; without fl_x, camera_angle_x or x_fov; without w and h, those of the
/// picture beside. Lenses are drawn as DrawnLenses (formats/distortion.h) says. Throws Error for all that is
/// missing or wrong, naming the frame and the key.
std::vector<Camera> load_transforms(const std::filesystem::path& path, const nlohmann::json& json);

}  // namespace binosplat
