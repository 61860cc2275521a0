#pragma once
// The stability study as a page and as JSON.

#include <nlohmann/json_fwd.hpp>

#include "study/page.h"
#include "study/stability.h"

namespace binosplat::study {

Page stability_page(const StabilityStudy& study);

/// scene, device, target_db, bounds (text to number), tolerances (by rule) and cases: for each its fear, and
/// rules, by whose names there are the members of StabilityResult. What is not finite becomes null.
nlohmann::ordered_json to_json(const StabilityStudy& study);

}  // namespace binosplat::study
