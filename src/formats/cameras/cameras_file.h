#pragma once
// Reads cameras from files: INRIA's cameras.json, COLMAP's reconstructions (formats/cameras/colmap.h),
// transforms.json (formats/cameras/transforms.h), nerfstudio's paths and poses
// (formats/cameras/nerfstudio.h), LichtFeld Studio's paths (formats/cameras/lichtfeld.h), recorded heads
// (formats/cameras/head_trace.h), and the cameras in a model's ply (formats/cameras/ply_camera.h) or glTF.
//
// cameras.json is a list of objects: img_name, width, height (px), position (x, y, z), rotation (three rows
// of three), fx, fy (px). The rotation is camera-to-world: its COLUMNS are the camera's axes x right, y down,
// z forward in the world. Optional keys: cx, cy (px; default: the middle of the picture), time (s) and those
// of lenses that are no pinholes (formats/cameras/distortion.h). Other keys are ignored.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scene/camera.h"

namespace binosplat {

/// Returns the path that load_cameras() reads: JSON, a csv, a ply, a glTF, or the folder of a COLMAP
/// reconstruction. `path` is one of these, or a folder that has one (else throws Error), or a file of a
/// reconstruction.
std::filesystem::path resolve_cameras(const std::filesystem::path& path);

/// Reads all cameras, at least one, from resolve_cameras(path). Cameras are in file order; COLMAP's are
/// sorted by name. Rotations that are rounded or scaled become the nearest ones (formats/cameras/lens.h). If
/// lacks_lenses() is true for the file, the vertical field of view is `fov_degrees` (default: 60). Names find
/// photos and name pictures: further cameras with the same name become NAME_2 and so on, with a warning.
/// Throws Error for an invalid camera (naming file, number in the list and key) or broken JSON (line and
/// byte), or if no camera's lens can be drawn (formats/cameras/distortion.h).
std::vector<Camera> load_cameras(const std::filesystem::path& path,
                                 const std::optional<double>& fov_degrees = {});

/// Returns whether a file has the poses of cameras without their lenses (formats/cameras/nerfstudio.h).
bool lacks_lenses(const std::filesystem::path& path);

/// Throws Error: `source` has no camera named `asked`. The text lists some of its cameras.
[[noreturn]] void fail_no_camera(const std::string& asked, const std::string& source,
                                 std::span<const Camera> cameras);

/// The names of test views, in which no tolerance may be found, and of training views.
struct TestSplit {
  std::vector<std::string> test, training;
  std::string how;  // how test and training views were separated, for the log
};

/// Every `every`th view by name is a test view, as is usual in the field. Without a number: every 8th, or the
/// test views of INRIA's trainer, whose cameras.json has test, then training views, each sorted by name.
/// `source` is the resolve_cameras() of the cameras, which are in its order.
TestSplit test_split(const std::string& source, std::span<const Camera> cameras,
                     const std::optional<int>& every);

/// Returns a camera as an object of cameras.json, with principal point and time (0 if the time is unknown).
nlohmann::ordered_json camera_json(const Camera& camera);

/// Returns the path of a model's cameras; `model` is the model's file or folder. Prefers the cameras in the
/// model's file, then cameras.json, transforms.json or a COLMAP reconstruction in the model's
/// folder, then MODEL for INRIA's MODEL/point_cloud/iteration_N/NAME.ply and MODEL/point_cloud/NAME.ply.
std::optional<std::filesystem::path> find_cameras(const std::filesystem::path& model);

/// Returns the folder of the cameras' photos. For transforms.json returns the file's own folder, because the
/// names in the file are relative to that folder. Otherwise returns `images` or `photos` in the folder of the
/// cameras, or, for a COLMAP reconstruction, also in the three folders above.
std::optional<std::filesystem::path> find_photos(const std::filesystem::path& cameras);

}  // namespace binosplat
