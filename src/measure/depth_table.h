#pragma once
// AdaGScale's table: the transmittance bound at each depth of a scene (Jo et al., sections 3.2 and 3.4;
// docs/method.md 5, `depth`).

#include <optional>
#include <span>
#include <vector>

#include "render/frame.h"

namespace binosplat::measure {

/// Default number of views to measure a table in.
constexpr std::size_t depth_table_views = 16;

struct DepthTableSettings {
  int bins = 20;  // the paper's number
  /// End of the bins, world units; the paper's is 100. None: the depth within which 95 % of the measured
  /// Gaussians lie, so that the bins fit the scene.
  std::optional<float> far;
  std::optional<int> order, projection;  // as in render::FrameSettings
};

/// Measures a table view by view, for programs that draw other frames in between.
class DepthTableMeasurement {
 public:
  /// Throws Error for invalid settings.
  explicit DepthTableMeasurement(const DepthTableSettings& settings);

  /// Draws the view exactly, and measures max(T) of each Gaussian on the GPU.
  void add(render::Frame& frame, const shared::View& view);

  /// The largest max(T) over all views of the Gaussians in each bin of view depth (of distance with
  /// PROJECTION_TANGENT). 0 for an empty bin; frames then use 1.
  DepthTable table() const;

 private:
  DepthTableSettings settings_;
  std::vector<render::MeasuredGaussian> measured_;
};

/// Measures all views at once. The frame must be of the same model. Throws Error for invalid settings.
DepthTable measure_depth_table(render::Frame& frame, std::span<const shared::View> views,
                               const DepthTableSettings& settings = {});

}  // namespace binosplat::measure
