#pragma once
// The page of rules along moving heads, and its tables, which the program prints, too.

#include <nlohmann/json.hpp>

#include "study/page.h"

namespace binosplat::study {

/// A row a rule of one of the study's paths (motion.h): what it came to where every rule was asked for the
/// same.
Table asked_table(const nlohmann::ordered_json& path);

/// The same at one true quality; without rows where that was not looked for.
Table target_table(const nlohmann::ordered_json& path);

/// "3 stretches of 60 frames, after 12 to find a loss; then a stop of 15": how long the segments of a path
/// are.
std::string lengths_of(const nlohmann::ordered_json& path);

/// From the study's JSON: device, scene, gaussians, eyes, width, height, frames_per_second, units_per_metre,
/// metre_source, quality_db, target_db, equal_pictures_db, rounds, and paths as motion.h has them.
Page motion_page(const nlohmann::ordered_json& results);

}  // namespace binosplat::study
