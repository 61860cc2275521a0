#pragma once
// AdaGScale's table: the transmittance bound at each depth of a scene (Jo et al., sections 3.2 and 3.4;
// docs/method.md 5, `depth`).

#include <optional>
#include <span>
#include <vector>

#include "render/frame.h"

namespace binosplat::measure {

/// The default number of views in which programs measure a table.
constexpr std::size_t depth_table_views = 16;

struct DepthTableSettings {
  int bins = 20;  // the paper's number
  /// The depth at which the last bin ends, in world units; 100 in the paper. None: the 95 % quantile of the
  /// measured Gaussians' depths, so that the bins fit the scene.
  std::optional<float> far = {};
  std::optional<Order> order = {};  // as in Settings
  std::optional<Projection> projection = {};
};

/// Measures a table view by view. Programs may draw other frames in between.
class DepthTableMeasurement {
 public:
  /// Throws Error for invalid settings.
  explicit DepthTableMeasurement(const DepthTableSettings& settings);

  /// Draws the view exactly, and measures max(T) of each Gaussian on the GPU.
  void add(render::Frame& frame, const shared::View& view);

  /// Returns for each bin the largest max(T) of its Gaussians over all views; 0 if the bin is empty (frames
  /// then use 1). Bins divide the view depth, or the distance with Projection::tangent.
  DepthTable table() const;

 private:
  DepthTableSettings settings_;
  std::vector<render::MeasuredGaussian> measured_;
};

/// Measures the table of all views, which are of the frame's model. Throws Error for invalid settings.
DepthTable measure_depth_table(render::Frame& frame, std::span<const shared::View> views,
                               const DepthTableSettings& settings = {});

}  // namespace binosplat::measure
