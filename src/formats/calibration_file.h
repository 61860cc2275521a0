#pragma once
// The file of a calibration of thresholds (scene/threshold_calibration.h).
//
// It is JSON: format "binosplat calibration", version 1; model (name, gaussians, hash); order and projection
// of the pictures; width, height, focal_px and near of the views; target (drop_db against the photos, or
// psnr_db against the exact pictures); depth_table (far, upper, seconds); views (name, position); and
// entries: th, transmittance, tolerance, reached_db and worst_db of worst_view in the target's terms,
// pairs_removed (share), evaluations, seconds.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "scene/threshold_calibration.h"

namespace binosplat {

nlohmann::ordered_json json_of(const ThresholdCalibration& calibration);

/// Reads a calibration. Throws Error naming the file and the key if it is invalid.
ThresholdCalibration load_calibration(const std::filesystem::path& path);
/// The same from a text; `name` names it in errors.
ThresholdCalibration parse_calibration(const std::string& name, const std::string& text);

}  // namespace binosplat
