#pragma once
// The camera in a model's ply: SHARP (apple/ml-sharp) makes a model from one photo, and stores the photo's
// camera in the model's file.
//
// The file also has elements with one number in each row: `intrinsic` (9: a matrix, row-major, px),
// `extrinsic` (16: world-to-camera, row-major; if missing, the camera is at the origin) and `image_size` (2:
// width and height, px). In SHARP's first version, `intrinsic` has 4 numbers (focal lengths, width and
// height), and `extrinsic` has 12: three rows whose first three columns are transposed.

#include "formats/containers/opened_file.h"
#include "scene/camera.h"

namespace binosplat {

constexpr const char* ply_camera_name = "photo";

bool has_ply_camera(const PlyHeader& header);

/// Reads that camera. If an element is missing, wrong or cut off, throws Error and
/// names the file, the element and the expected value.
Camera load_ply_camera(const OpenedFile& file);

}  // namespace binosplat
