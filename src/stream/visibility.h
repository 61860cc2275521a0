#pragma once
// The visibility pass: measures on the GPU how much of a model's chunks the views show
// (stream/level_choice.h).

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "render/frame.h"
#include "render/squared_error.h"
#include "scene/model_chunks.h"
#include "stream/level_choice.h"

namespace binosplat {

class Visibility {
 public:
  /// Other frames may draw the same model. The model must not be of Scaffold-GS. The model's context must be
  /// current in every call.
  explicit Visibility(std::shared_ptr<render::GpuModel> model);

  /// Returns, for each view, the visibility of each of the model's `chunks`. Draws large views with fewer
  /// pixels: divides width and height by up to `max_shrink` (default: the fastest on this device), but keeps
  /// at least 512 px. Uses `settings.precision` and the settings that exact_of() keeps. Distances are
  /// geometric means, up to 2^32 world units. The result is deterministic. Throws as Frame::draw() does.
  std::vector<std::vector<ChunkVisibility>> measure(std::span<const shared::View> views,
                                                    const render::FrameSettings& settings,
                                                    const ModelChunks& chunks,
                                                    std::optional<int> max_shrink = {});

  /// Draws the view at full size, and keeps that picture.
  void keep_picture(const shared::View& view, const render::FrameSettings& settings);
  /// Draws the view again and returns its mean squared difference from the kept picture.
  double picture_error(const shared::View& view, const render::FrameSettings& settings);

 private:
  std::vector<std::int64_t> sum_up(std::size_t views, int precision, const ModelChunks& chunks);

  render::Frame frame_;
  gl::Dispatcher dispatcher_;
  /// By splat, two sums over tiles: of the low VISIBILITY_LOW_BITS of a tile's alpha T^2, and of its high
  /// bits.
  gl::Buffer sums_;
  gl::Buffer owners_;  // chunk of each block, uint
  /// By view, then chunk: alpha T^2 in 64 bits, then alpha T^2 times the logarithm of the distance.
  gl::Buffer of_chunks_;
  render::SquaredError kept_;
};

}  // namespace binosplat
