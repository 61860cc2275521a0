#pragma once
// The camera in a model's own ply: SHARP (apple/ml-sharp) makes a model from one photo, and stores that
// photo's camera in the file.
//
// Besides the vertices there are elements of one number a row: `intrinsic` (9: a matrix, row-major, px),
// `extrinsic` (16: world-to-camera, row-major) and `image_size` (2: width and height, px). In files of its
// first version, `intrinsic` has 4 numbers (the focal lengths, width and height). Their `extrinsic` has 12:
// three rows whose first three columns are transposed. Without `extrinsic` the camera is at the origin.

#include <cstddef>
#include <filesystem>
#include <span>

#include "scene/camera.h"

namespace binosplat {

/// The camera's name.
constexpr const char* ply_camera_name = "photo";

/// Returns whether a file is a ply with such elements; false if its header cannot be read.
bool has_ply_camera(const std::filesystem::path& path);

/// Reads that camera from the file's bytes. Throws Error naming the file, the element and the expected value
/// if it is missing or wrong, or if the file ends before it.
Camera load_ply_camera(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace binosplat
