#pragma once
// The camera in a model's own ply: SHARP (apple/ml-sharp) makes a model of one photo, and leaves in
// the file how it was taken.
//
// Beside the vertices are elements with one number in each row: `intrinsic` (9: a matrix, row by row, px),
// `extrinsic` (16: world-to-camera, row by row) and `image_size` (2: width and height, px). Files of its
// first version have the focal lengths, width and height as 4 numbers in `intrinsic`, and 12 in `extrinsic`,
// three rows of which the first three columns are transposed. Without `extrinsic` the camera is at the
// origin.

#include <cstddef>
#include <filesystem>
#include <span>

#include "scene/camera.h"

namespace binosplat {

/// What such a camera is called.
constexpr const char* ply_camera_name = "photo";

/// Whether a file is a ply with such elements; false, too, for a ply whose header cannot be read.
bool has_ply_camera(const std::filesystem::path& path);

/// That camera, of the file's bytes. Throws Error naming the file, the element and what was expected for one
/// that is missing or wrong, and for a ply that ends before it.
Camera load_ply_camera(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace binosplat
