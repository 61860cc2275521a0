#pragma once
// Cameras of COLMAP's reconstructions, binary or text: cameras.* (lenses) and images.* (poses).

#include <filesystem>
#include <vector>

#include "scene/camera.h"

namespace binosplat {

bool is_colmap(const std::filesystem::path& folder);

/// Reads all cameras of a folder, sorted by the names of their pictures. If binary and text files exist,
/// reads the binary ones. Distorted pinholes are drawn without the distortion, and a warning names the
/// command to undistort them; fisheyes and panoramas cannot be drawn (LensReport,
/// formats/cameras/distortion.h). If something is damaged, cut short or missing, throws Error and names the
/// file and the image or line.
std::vector<Camera> load_colmap(const std::filesystem::path& folder);

}  // namespace binosplat
