#pragma once
// Cameras of COLMAP's reconstructions, binary or text: cameras.* (lenses) and images.* (poses). points3D.* is
// not read.

#include <filesystem>
#include <vector>

#include "scene/camera.h"

namespace binosplat {

/// Returns whether a folder contains such a reconstruction.
bool is_colmap(const std::filesystem::path& folder);

/// Reads all cameras of a folder, sorted by the names of their pictures, from the binary files if both kinds
/// exist. LensReport (formats/distortion.h) defines how lenses are drawn: distorted pinholes without the
/// distortion, with a warning that names the command to undistort; fisheyes and panoramas not at all. Throws
/// Error naming the file, and the image or line in it, if something is damaged, cut short or missing.
std::vector<Camera> load_colmap(const std::filesystem::path& folder);

}  // namespace binosplat
