#pragma once
// Cameras as INRIA's trainer leaves them beside a model: cameras.json.
//
// A list of objects: img_name, width, height (px), position (x, y, z), rotation (three rows of three; its
// COLUMNS are the camera's axes x right, y down, z forward in the world, so it is camera-to-world), fx, fy
// (px). Optional: cx, cy (px; the middle of the picture where missing) and time (s). Other keys are ignored.

#include <filesystem>
#include <optional>
#include <vector>

#include "scene/camera.h"

namespace binosplat {

/// Reads all cameras in file order; at least one. Rotations must be orthonormal within 1e-3 with determinant
/// +1 and are kept to the digit. Names that occur twice are kept with a warning. Throws Error naming the
/// file, the camera's number in the list and its key; for broken JSON the line and byte.
std::vector<Camera> load_cameras(const std::filesystem::path& path);

/// The cameras.json that belongs to a model, a file or its folder: in that folder or, for INRIA's
/// MODEL/point_cloud/iteration_N/NAME.ply and MODEL/point_cloud/NAME.ply, in MODEL.
std::optional<std::filesystem::path> find_cameras(const std::filesystem::path& model);

}  // namespace binosplat
