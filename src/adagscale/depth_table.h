#pragma once
// AdaGScale's table: the transmittance bound at each depth of a scene (Jo et al., sections 3.2 and 3.4,
// equation 7; docs/method.md 5, `depth`).

#include <optional>
#include <span>

#include "render/frame.h"

namespace binosplat::adagscale {

struct DepthTableSettings {
  int bins = 20;  // the paper's number
  /// The depth at which the last bin ends, in world units; 100 in the paper. None: the 95 % quantile of the
  /// measured Gaussians' depths, so that the bins fit the scene.
  std::optional<float> far = {};
  render::FrameSettings frame = {};  // its order, projection and precision are those of the frames
};

/// Draws each view exactly, and measures max(T) of each Gaussian on the GPU. Returns for each bin the largest
/// max(T) of its Gaussians over all views; 0 if the bin is empty (frames then use 1). Bins divide the view
/// depth, or the distance with Projection::tangent. The views are of the frame's model. Throws Error for
/// invalid settings.
DepthTable measure_depth_table(render::Frame& frame, std::span<const shared::View> views,
                               const DepthTableSettings& settings = {});

}  // namespace binosplat::adagscale
