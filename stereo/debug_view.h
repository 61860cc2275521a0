#pragma once
// What of a frame may be shown in place of its pictures (SHOW_ of shared/axes.h), in colours that
// colour-blind eyes tell apart. Files and the preview show the same.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "render/frame.h"

namespace binosplat::stereo {

/// Which debug views need both eyes, and which are maps: numbers, shown as colours.
constexpr bool needs_both_eyes(int show) { return show == SHOW_DISAGREEMENT; }
constexpr bool is_map(int show) { return show >= SHOW_DIFFERENCE; }

/// The colour of a number from 0 to 1, others as the nearer end: viridis, from dark blue over green to
/// yellow, whose lightness alone tells.
glm::vec3 map_colour(float number);

struct DebugPictures {
  std::vector<Picture> pictures;  // one a view; maps have no depth, and T is 1 where there is no number
  std::optional<double> most;     // for maps: the number of the brightest colour; the darkest is 0
};

/// A frame that was drawn: its own pictures, and what it was asked to draw, left eye first.
struct DrawnFrame {
  render::Frame& frame;
  std::span<const shared::View> views;
  std::span<const Picture> pictures;
  const render::FrameSettings& settings;
};

/// Makes debug views of the last frame that was drawn, whatever its settings.
class DebugView {
 public:
  /// For frames of this model. Context as for render::Frame.
  explicit DebugView(std::shared_ptr<render::GpuModel> model) : model_(std::move(model)) {}

  /// All views share one range, which ends at the first of 1, 2, 5, 10 and so on that 99 of 100 pixels do not
  /// exceed; of depths, 80 of 100. SHOW_SPLIT shows the share `split` of each picture's width as it is, and
  /// the rest exactly. Throws Error as render::Frame does.
  DebugPictures make(int what, const DrawnFrame& drawn, const Background& background, double split = 0.5);

  /// The exact pictures of these views. A Frame of their own draws them, so that the other one's history
  /// stays.
  std::vector<Picture> exact(std::span<const shared::View> views, const render::FrameSettings& settings);
  /// What that frame took.
  const render::FrameReport& exact_report() const { return exact_report_; }

  /// Gives the memory of that frame back.
  void release() { exact_.reset(); }

 private:
  void draw_exact(std::span<const shared::View> views, const render::FrameSettings& settings);
  std::vector<Image> map(int what, const DrawnFrame& drawn, const Background& background);

  std::shared_ptr<render::GpuModel> model_;
  std::unique_ptr<render::Frame> exact_;
  render::FrameReport exact_report_;
};

}  // namespace binosplat::stereo
