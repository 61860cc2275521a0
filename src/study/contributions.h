#pragma once
// What single Gaussians contribute to a view, and what a picture loses without the lowest contributions
// (AdaGScale, figures 4 to 6). In float64 on the CPU: how the frame draws plays no part in it.

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>

#include "base/image.h"
#include "render/settings.h"
#include "scene/model.h"
#include "shared/types.h"

namespace binosplat::study {

struct ContributionView {
  std::string name;
  shared::View view;
  std::optional<Image> photo;  // RGB in the view's size
};

/// JSON of two lists. `skipping`, by what is known of the light: by ("alpha T", "alpha max(T)", "alpha
/// T_upper(depth)", "alpha") and points of share (of the fragments skipped, as reference/skipping.h counts
/// them), psnr_db against exact (at most 100) and, with photos, drop_db; means over the views. `by_depth`, by
/// bins of view depth up to where 95 % of what is drawn lies nearer: from, to, gaussians (that a pixel
/// blends), and the median, the 90th of a hundred and the largest of their `contribution` (the largest alpha
/// T of a pixel) and `light` (max(T)), and the table's `upper`. `progress` is called after each view.
nlohmann::ordered_json contributions(const Model& model, std::span<const ContributionView> views,
                                     const render::DepthTable& table, const std::function<void()>& progress);

}  // namespace binosplat::study
