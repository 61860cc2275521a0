#pragma once
// What single Gaussians contribute to a view by distance from their middles, the transmittance in front of
// them by depth, and what a picture loses without the lowest contributions (AdaGScale, figures 4 to 6). In
// float64 on the CPU: how the frame draws plays no part in it.

#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/image.h"
#include "reference/skipping.h"
#include "render/settings.h"
#include "scene/model.h"
#include "shared/types.h"

namespace binosplat::lab {

struct ContributionView {
  std::string name;
  shared::View view;
  std::optional<Image> photo;  // RGB in the view's size
  glm::mat4x3 exposure{1.0f};  // of pictures, before they are compared with it
};

/// What the pictures keep without the lowest contributions, by what is known of the transmittance; means over
/// the views.
struct SkippingCurve {
  struct Point {
    double share = 0.0;             // of the fragments skipped, as reference/skipping.h counts them
    double psnr_db = 0.0;           // against exact, at most 100
    std::optional<double> drop_db;  // with photos
  };
  std::string by;  // "alpha T", "alpha max(T)", "alpha T_upper(depth)", "alpha"
  std::vector<Point> points;
};

/// Of the Gaussians of a bin; not numbers for none.
struct Spread {
  double median = NAN, p90 = NAN, largest = NAN;
};

struct DepthBin {
  double from = 0.0, to = 0.0;  // view depth, world units
  std::size_t gaussians = 0;    // that a pixel blends
  Spread transmittance;         // max(T)
  double bound = 0.0;           // the table's
};

struct Contributions {
  std::vector<SkippingCurve> skipping;
  std::vector<reference::DistanceBin> by_distance;  // of all views; up to the last that has fragments
  std::vector<DepthBin> by_depth;                   // up to where 95 % of what is drawn lies nearer
};

/// T_upper(depth) is the `table`'s for skipping, and the `fitted` one's for the bins of depth. `progress` is
/// called after each view.
Contributions contributions(const Model& model, std::span<const ContributionView> views,
                            const DepthTable& table, const DepthTable& fitted,
                            const std::function<void()>& progress);

}  // namespace binosplat::lab
