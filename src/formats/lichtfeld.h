#pragma once
// The camera paths of LichtFeld Studio's sequencer: keys with times, poses and focal lengths.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "scene/camera.h"

namespace binosplat {

/// Whether a JSON file is one: its keyframes have a focal_length_mm.
bool is_lichtfeld_path(const nlohmann::json& root);

/// Reads the keys, called key_000 and so on, in the order of their times; they start at 0. Lenses are in
/// millimetres of a picture 24 mm high, and pictures have no size: pose_width by pose_height. Its world is
/// the model's with y and z the other way. How a key eases into the next one, and moving anything but the
/// camera, is left out and said. Throws Error naming the key.
std::vector<Camera> load_lichtfeld_path(const std::filesystem::path& path, const nlohmann::json& json);

}  // namespace binosplat
