#pragma once
// The file of a threshold calibration (calibration.h): a JSON object with the keys format
// ("binosplat calibration"), version (4), model (name, gaussians, hash), depth_table (far, upper, seconds),
// the pictures' order and projection, and the views' width, height, focal_px and near. `target` has drop_db
// against the photos or psnr_db against the exact pictures. `views` lists name and position. `reach` is
// missing if it is infinite. `entries` has the results: threshold, transmittance, tolerance, reached_db,
// worst_view, worst_db (drops or PSNRs, like the target), pairs_removed (a share of the splat-tile pairs),
// evaluations and seconds.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "adagscale/calibration.h"

namespace binosplat::adagscale {

nlohmann::ordered_json json_of(const ThresholdCalibration& calibration);

/// Reads a calibration. Throws Error naming the file and the key if it is invalid.
ThresholdCalibration load_calibration(const std::filesystem::path& path);
ThresholdCalibration parse_calibration(const std::string& name, const std::string& text);

}  // namespace binosplat::adagscale
