#pragma once
// Debug views: maps of a frame that replace its pictures (SHOW_ of shared/axes.h), in colours that
// colour-blind eyes can distinguish. Files and the preview show the same.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "render/frame.h"

namespace binosplat::stereo {

/// Whether a debug view needs both eyes, and whether it is a colour map of numbers.
constexpr bool needs_both_eyes(int show) { return show == SHOW_DISAGREEMENT; }
constexpr bool is_map(int show) { return show >= SHOW_DIFFERENCE; }

/// The colour of a number, clamped to [0, 1]: viridis, from dark blue over green to yellow. Its lightness
/// alone is unambiguous.
glm::vec3 map_colour(float number);

struct DebugPictures {
  std::vector<Picture> pictures;  // one per view; maps have no depth, and T = 1 for pixels without a number
  std::optional<double> most;     // of maps: the number of the brightest colour; the darkest is 0
};

/// A drawn frame: its pictures, and the views and settings that it was drawn with, left eye first.
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

  /// All views share one range. It ends at the first of 1, 2, 5, 10 and so on that 99 of 100 pixels do not
  /// exceed; for depths, 80 of 100. SHOW_SPLIT shows the picture in the share `split` of its width, and the
  /// exact one in the rest. Throws Error as render::Frame does.
  DebugPictures make(int what, const DrawnFrame& drawn, const Background& background, double split = 0.5);

  /// The exact pictures of these views. Another Frame draws them, so that the drawn frame's history stays.
  std::vector<Picture> exact(std::span<const shared::View> views, const render::FrameSettings& settings);
  /// The report of that frame.
  const render::FrameReport& exact_report() const { return exact_report_; }

  /// Frees that frame's memory.
  void release() { exact_.reset(); }

 private:
  void draw_exact(std::span<const shared::View> views, const render::FrameSettings& settings);
  std::vector<Image> map(int what, const DrawnFrame& drawn, const Background& background);

  std::shared_ptr<render::GpuModel> model_;
  std::unique_ptr<render::Frame> exact_;
  render::FrameReport exact_report_;
};

}  // namespace binosplat::stereo
