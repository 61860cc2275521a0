#pragma once
// Camera paths of LichtFeld Studio's sequencer: keys with times, poses and focal lengths.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "scene/camera.h"

namespace binosplat {

/// Returns whether a JSON file is such a path: its keyframes have a focal_length_mm.
bool is_lichtfeld_path(const nlohmann::json& root);

/// Reads the keys, named key_000 and so on, sorted by time, starting at 0. Focal lengths are in millimetres
/// of a picture 24 mm high; pictures have no size and get pose_width by pose_height. Its world is the model's
/// with y and z reversed. Easing between keys and animations of anything but the camera are ignored, with a
/// message. Throws Error naming the key.
std::vector<Camera> load_lichtfeld_path(const std::filesystem::path& path, const nlohmann::json& json);

}  // namespace binosplat
