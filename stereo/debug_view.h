#pragma once
// Debug views: maps of a frame that replace its pictures (SHOW_ of shared/choices.h), in colours that
// colour-blind eyes can distinguish. Files and the preview show the same colours.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "render/frame.h"

namespace binosplat::stereo {

/// The colour of a number, clamped to [0, 1]: viridis, from dark blue over green to yellow. The lightness
/// alone identifies the number.
glm::vec3 map_colour(float number);

struct DebugPictures {
  std::vector<Picture> pictures;  // one per view; maps have no depth, and T is 1 in pixels without a number
  std::optional<double> max;      // for maps: the number of the brightest colour; the darkest is 0
};

/// A drawn frame, its views, pictures and settings. The left eye comes first.
struct DrawnFrame {
  render::Frame& frame;
  std::span<const shared::View> views;
  std::span<const Picture> pictures;
  const render::FrameSettings& settings;
};

/// Makes debug views of the last frame, for any settings.
class DebugView {
 public:
  /// For frames of this model. The context must be current, as for render::Frame.
  explicit DebugView(std::shared_ptr<render::GpuModel> model) : model_(std::move(model)) {}

  /// The maps of all views share one range, from 0 to the first of 1, 2, 5, 10 and so on that 99 % of the
  /// pixels do not exceed (80 % for depths). SHOW_SPLIT shows the picture on the left, up to `split` times
  /// its width, and the exact picture on the right. Throws Error as render::Frame does.
  DebugPictures make(int what, const DrawnFrame& drawn, const Background& background, double split = 0.5);

  /// The numbers behind a map (SHOW_DIFFERENCE and later), by view; below 0 where a pixel has none.
  std::vector<Image> map(int what, const DrawnFrame& drawn, const Background& background);

  /// The exact pictures of these views. Another Frame draws them, so that the drawn frame's history stays.
  std::vector<Picture> exact(std::span<const shared::View> views, const render::FrameSettings& settings);
  const Report& exact_report() const { return exact_report_; }

  void release() { exact_.reset(); }

 private:
  void draw_exact(std::span<const shared::View> views, const render::FrameSettings& settings);

  std::shared_ptr<render::GpuModel> model_;
  std::unique_ptr<render::Frame> exact_;
  Report exact_report_;
};

}  // namespace binosplat::stereo
