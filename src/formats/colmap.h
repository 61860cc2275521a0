#pragma once
// Cameras as COLMAP's reconstructions have them, binary or text: cameras.* (lenses) and images.* (poses), and
// points3D.*, which is not read.

#include <filesystem>
#include <vector>

#include "scene/camera.h"

namespace binosplat {

/// Whether a folder holds such a reconstruction.
bool is_colmap(const std::filesystem::path& folder);

/// Reads all cameras of a folder, sorted by the names of their pictures; binary files where both are there.
/// Lenses are drawn as DrawnLenses (formats/distortion.h) says: those that project as a pinhole does and then
/// bend the picture without the bend, with a warning that names what undistorts them; fisheyes and panoramas
/// not at all. Throws Error naming the file, and the image or line in it, for what is damaged, cut short or
/// missing.
std::vector<Camera> load_colmap(const std::filesystem::path& folder);

}  // namespace binosplat
