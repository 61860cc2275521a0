#pragma once
// The page of the stability study.

#include <nlohmann/json.hpp>

#include "study/page.h"

namespace binosplat::study {

/// From the study's JSON: scene, device, target_db, bounds (text to number), losses (by rule) and cases: for
/// each its fear, and rules, by whose names there are verdict, worst_db, worst_frame, settled_db,
/// settling_frames, largest_error, mean_signed_error, disagreement_db and pairs_removed.
Page stability_page(const nlohmann::ordered_json& results);

}  // namespace binosplat::study
