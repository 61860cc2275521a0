#pragma once
// The float64 judge: one view from model to picture on the CPU, as docs/method.md defines it. The stages by
// themselves are in project.h, threshold.h, tiles.h and blend.h.

#include <optional>

#include "base/image.h"
#include "reference/blend.h"
#include "reference/decode.h"
#include "reference/project.h"
#include "reference/threshold.h"
#include "reference/tiles.h"
#include "reference/trace.h"
#include "reference/transmittance.h"

namespace binosplat::reference {

struct Settings {
  int tiles = TILES_ELLIPSE;
  int tile_size = TILE_SIZE_DEFAULT;  // px
  int th = TH_TAU;
  double tolerance = 0.0;                  // of threshold()
  std::vector<double> bounds;              // T_upper or W by Gaussian; empty: 1 for all
  Decoding decoding;                       // of a Scaffold-GS model
  std::optional<Perspective> perspective;  // none: what the model was trained with
  std::vector<float> mesh_depths;          // of TileLists
};

/// The picture of a model in a view. The view's members for the frame (from tiles_x on) are not looked
/// at.
Picture render(const Model& model, const shared::View& view, const Settings& settings = {});

}  // namespace binosplat::reference
