#pragma once
// AdaGScale's table: the transmittance bound at each depth of a scene (Jo et al., sections 3.2 and 3.4;
// docs/method.md 5, `depth`).

#include <optional>
#include <span>

#include "render/frame.h"

namespace binosplat::measure {

struct DepthTableSettings {
  int bins = 20;  // the paper's number
  /// Where the bins end, world units; the paper's is 100. None: where 95 % of what the views draw lies
  /// nearer, so that the bins fit the scene.
  std::optional<float> far;
  std::optional<int> order, projection;  // as render::FrameSettings has them
};

/// The largest max(T) of the views' exact frames among the Gaussians of each bin of view depth (with
/// PROJECTION_TANGENT of distance), measured on the GPU; 0 for a bin that no view saw anything in, which a
/// frame takes for 1. The frame must be of the same model. Throws Error for settings that make no table.
render::DepthTable measure_depth_table(render::Frame& frame, std::span<const shared::View> views,
                                       const DepthTableSettings& settings = {});

}  // namespace binosplat::measure
