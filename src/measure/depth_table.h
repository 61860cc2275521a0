#pragma once
// AdaGScale's table: the transmittance bound at each depth of a scene (Jo et al., sections 3.2 and 3.4;
// docs/method.md 5, `depth`).

#include <optional>
#include <span>
#include <vector>

#include "render/frame.h"

namespace binosplat::measure {

/// How many views a table is measured in where nothing else is asked for.
constexpr std::size_t depth_table_views = 16;

struct DepthTableSettings {
  int bins = 20;  // the paper's number
  /// Where the bins end, world units; the paper's is 100. None: where 95 % of what the views draw lies
  /// nearer, so that the bins fit the scene.
  std::optional<float> far;
  std::optional<int> order, projection;  // as render::FrameSettings has them
};

/// Measures a table view by view, for programs that draw other frames meanwhile.
class DepthTableMeasurement {
 public:
  /// Throws Error for settings that make no table.
  explicit DepthTableMeasurement(const DepthTableSettings& settings);

  /// Draws the view exactly, and measures max(T) of each Gaussian on the GPU.
  void add(render::Frame& frame, const shared::View& view);

  /// The largest max(T) of all views among the Gaussians of each bin of view depth (with PROJECTION_TANGENT
  /// of distance); 0 for a bin that no view saw anything in, which a frame takes for 1.
  DepthTable table() const;

 private:
  DepthTableSettings settings_;
  std::vector<render::MeasuredGaussian> measured_;
};

/// All at once. The frame must be of the same model. Throws Error for settings that make no table.
DepthTable measure_depth_table(render::Frame& frame, std::span<const shared::View> views,
                               const DepthTableSettings& settings = {});

}  // namespace binosplat::measure
