#pragma once
// Reads cameras from files: INRIA's cameras.json, COLMAP's reconstructions (formats/colmap.h),
// transforms.json (formats/transforms.h), nerfstudio's paths and poses (formats/nerfstudio.h), LichtFeld
// Studio's paths (formats/lichtfeld.h), and the camera in a model's ply (formats/ply_camera.h).
//
// cameras.json is a list of objects: img_name, width, height (px), position (x, y, z), rotation (three rows
// of three), fx, fy (px). The rotation is camera-to-world: its COLUMNS are the camera's axes x right, y down,
// z forward in the world. Optional: cx, cy (px; default: the middle of the picture), time (s) and the keys of
// lenses that are no pinholes (formats/distortion.h). Other keys are ignored.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scene/camera.h"

namespace binosplat {

/// Returns the path that load_cameras() reads: a JSON file, a ply, or the folder of a COLMAP reconstruction.
/// `path` is one of these, a folder that contains one, or a file of a reconstruction. Throws Error for a
/// folder without cameras.
std::filesystem::path resolve_cameras(const std::filesystem::path& path);

/// Reads all cameras, at least one, of a file or of a folder that contains such files, also in sparse/0 below
/// it. They are in file order, COLMAP's by name. Rotations must be orthonormal within 1e-3 with determinant
/// +1; they are kept to the digit. For files that lacks_lenses(), the vertical field of view is
/// `fov_degrees`, or 60. Names must be unique, since they find photos and name pictures: later cameras of one
/// name become NAME_2 and so on, with a warning. Throws Error naming the file, the camera's number in the
/// list and its key; for broken JSON, the line and byte. Throws Error if no camera's lens can be drawn
/// (formats/distortion.h).
std::vector<Camera> load_cameras(const std::filesystem::path& path,
                                 const std::optional<double>& fov_degrees = {});

/// Returns whether a file has the poses of cameras without their lenses (formats/nerfstudio.h).
bool lacks_lenses(const std::filesystem::path& path);

/// Throws Error: `source` has no camera named `asked`. The text lists some that it has.
[[noreturn]] void fail_no_camera(const std::string& asked, const std::string& source,
                                 std::span<const Camera> cameras);

/// Returns a camera as an object of cameras.json, with its principal point and its time (0 if it has none).
nlohmann::ordered_json camera_json(const Camera& camera);

/// Returns the path of the cameras of a model, a file or its folder. A ply with a camera
/// (formats/ply_camera.h) is that path itself. Otherwise it is cameras.json, transforms.json or a COLMAP
/// reconstruction in the model's folder. For INRIA's MODEL/point_cloud/iteration_N/NAME.ply and
/// MODEL/point_cloud/NAME.ply the folder is MODEL, if the model's has none.
std::optional<std::filesystem::path> find_cameras(const std::filesystem::path& model);

/// Returns the folder of the photos of these cameras: `images` or `photos` beside their file, or beside the
/// folders around a reconstruction. For transforms.json it is its own folder, to which its names are
/// relative.
std::optional<std::filesystem::path> find_photos(const std::filesystem::path& cameras);

}  // namespace binosplat
