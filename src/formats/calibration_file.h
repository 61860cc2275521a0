#pragma once
// The file that keeps a calibration of thresholds (scene/threshold_calibration.h).
//
// It is JSON: format "binosplat calibration", version 1; model (name, gaussians, hash), order and projection
// that it holds for, width, height, focal_px and near of the views, views (name, position), target (drop_db
// against the photos, or psnr_db against the exact pictures), depth_table (far, upper) and entries: th,
// transmittance, tolerance, and what it reached: reached_db and worst_db of worst_view in the target's terms,
// pairs_removed (share), evaluations, seconds.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "scene/threshold_calibration.h"

namespace binosplat {

nlohmann::ordered_json json_of(const ThresholdCalibration& calibration);

/// Throws Error naming the file and the key for anything that is not such a file.
ThresholdCalibration load_calibration(const std::filesystem::path& path);
/// The same from its text; `name` is for errors.
ThresholdCalibration parse_calibration(const std::string& name, const std::string& text);

}  // namespace binosplat
