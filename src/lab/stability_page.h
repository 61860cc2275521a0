#pragma once
// The stability study as a page and as JSON.

#include <nlohmann/json_fwd.hpp>

#include "lab/page.h"
#include "lab/stability.h"

namespace binosplat::lab {

Page stability_page(const StabilityStudy& study);

/// scene, device, target_db, bounds (text to number), tolerances (by rule) and cases: for each its fear, and
/// rules, by whose names there are the members of StabilityResult. What is not finite becomes null.
nlohmann::ordered_json to_json(const StabilityStudy& study);

}  // namespace binosplat::lab
