#pragma once
// The file of a threshold calibration (scene/threshold_calibration.h).
//
// It is a JSON object. Its keys are format ("binosplat calibration"), version (1), model (name, gaussians,
// hash) and depth_table (far, upper, seconds). The pictures' order and projection follow, and the views'
// width, height, focal_px and near. `target` has drop_db against the photos or psnr_db against the exact
// pictures. `views` lists name and position, and `entries` the results. An entry has th, transmittance,
// tolerance, reached_db, worst_view, worst_db, pairs_removed (a share of the splat-tile pairs), evaluations
// and seconds. reached_db and worst_db are drops or PSNRs, like the target.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "scene/threshold_calibration.h"

namespace binosplat {

nlohmann::ordered_json json_of(const ThresholdCalibration& calibration);

/// Reads a calibration. Throws Error naming the file and the key if it is invalid.
ThresholdCalibration load_calibration(const std::filesystem::path& path);
/// Parses the text of such a file. Errors name the file `name`.
ThresholdCalibration parse_calibration(const std::string& name, const std::string& text);

}  // namespace binosplat
