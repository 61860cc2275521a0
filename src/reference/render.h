#pragma once
// The float64 reference: draws a view of a model on the CPU as docs/method.md defines it. Its stages are in
// project.h, threshold.h, tiles.h and blend.h.

#include <optional>

#include "base/image.h"
#include "reference/adagscale_threshold.h"
#include "reference/adagscale_transmittance.h"
#include "reference/blend.h"
#include "reference/decode.h"
#include "reference/near_decisions.h"
#include "reference/project.h"
#include "reference/tiles.h"

namespace binosplat::reference {

struct Settings {
  int tiles = TILES_ELLIPSE;
  Threshold threshold = Threshold::exact;
  double tolerance = 0.0;                  // the argument of threshold()
  std::vector<double> bounds;              // T_upper of each Gaussian; empty: 1 for all
  bool anchor_cull = true;                 // for a Scaffold-GS model
  std::optional<Perspective> perspective;  // none: as the model was trained
  std::vector<float> mesh_depths;          // as TileLists::mesh_depths
};

/// Returns the picture of a model in a view. Ignores the view's members from tiles_x on (for frames only).
Picture render(const Model& model, const shared::View& view, const Settings& settings = {});

}  // namespace binosplat::reference
