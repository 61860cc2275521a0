#pragma once
// Camera paths of LichtFeld Studio's sequencer: keys with times, poses and focal lengths.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "scene/camera.h"

namespace binosplat {

bool is_lichtfeld_path(const nlohmann::json& root);

/// Reads the keys as cameras named key_000 and so on, sorted by time; times start at 0. Focal lengths are in
/// millimetres, for a picture 24 mm high. The file has no picture sizes; cameras get pose_width by
/// pose_height. The path's world is the model's with y and z negated. Easing between keys and animation clips
/// are ignored, with a message. For missing or wrong values, throws Error and names the JSON key.
std::vector<Camera> load_lichtfeld_path(const std::filesystem::path& path, const nlohmann::json& json);

}  // namespace binosplat
