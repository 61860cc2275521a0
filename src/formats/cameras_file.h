#pragma once
// Cameras from files: INRIA's cameras.json, COLMAP's reconstructions (formats/colmap.h), transforms.json
// (formats/transforms.h), nerfstudio's paths and poses (formats/nerfstudio.h), LichtFeld Studio's paths
// (formats/lichtfeld.h), and the camera in a model's ply (formats/ply_camera.h).
//
// cameras.json is a list of objects: img_name, width, height (px), position (x, y, z), rotation (three rows
// of three; its COLUMNS are the camera's axes x right, y down, z forward in the world, so it is
// camera-to-world), fx, fy (px). Optional: cx, cy (px; the middle of the picture where missing), time (s) and
// the keys of lenses that are no pinholes (formats/distortion.h). Other keys are ignored.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scene/camera.h"

namespace binosplat {

/// What load_cameras() reads: a JSON file, a ply, or the folder of a COLMAP reconstruction. `path` may be
/// that, a folder that holds it, or a file of a reconstruction. Throws Error for a folder without cameras.
std::filesystem::path resolve_cameras(const std::filesystem::path& path);

/// Reads all cameras, at least one, of a file or of a folder that holds such files, also in sparse/0 below
/// it. In file order, COLMAP's by name. Rotations must be orthonormal within 1e-3 with determinant +1 and are
/// kept to the digit. Of a file that lacks_lenses() pictures are `fov_degrees` high, or 60. Photos and
/// pictures are matched by names: of cameras of one name the second is called NAME_2 and so on, with a
/// warning. Throws Error naming the file, the camera's number in the list and its key, for broken JSON the
/// line and byte, and where no camera's lens can be drawn (formats/distortion.h).
std::vector<Camera> load_cameras(const std::filesystem::path& path,
                                 const std::optional<double>& fov_degrees = {});

/// Whether a file has the poses of cameras, but nothing of their lenses (formats/nerfstudio.h).
bool lacks_lenses(const std::filesystem::path& path);

/// Throws Error: `source` has no camera of the name that was `asked` for, and names some that it has.
[[noreturn]] void fail_no_camera(const std::string& asked, const std::string& source,
                                 std::span<const Camera> cameras);

/// A camera as an object of such a list, with its principal point, and its time (0 where it has none).
nlohmann::ordered_json camera_json(const Camera& camera);

/// The cameras that belong to a model, a file or its folder: the model itself, where it is a ply that has one
/// (formats/ply_camera.h), else cameras.json, transforms.json or a COLMAP reconstruction in that folder or,
/// for INRIA's MODEL/point_cloud/iteration_N/NAME.ply and MODEL/point_cloud/NAME.ply, in MODEL.
std::optional<std::filesystem::path> find_cameras(const std::filesystem::path& model);

/// The folder of the photos that cameras were found from: `images` or `photos` beside their file, or beside
/// the folders that a reconstruction lies in; for transforms.json its own folder, which its names start from.
std::optional<std::filesystem::path> find_photos(const std::filesystem::path& cameras);

}  // namespace binosplat
