#pragma once
// The visibility pass: measures what views show of the chunks of a model on the GPU, for choosing levels of
// detail (stream/choice.h).

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "render/frame.h"
#include "render/squared_error.h"
#include "scene/model_chunks.h"
#include "stream/choice.h"

namespace binosplat {

class Visibility {
 public:
  /// The model may have other users, and must not be of Scaffold-GS. Its context must be current in every
  /// call.
  explicit Visibility(std::shared_ptr<render::GpuModel> model);

  /// Returns, for each view, the visibility of each of the model's `chunks`. Draws the views, large ones
  /// shrunk by up to `shrink_most` along each axis (default: the fastest here), but not below 512 px. Uses
  /// the settings that exact_of() keeps, and the precision. Distances are means of the logarithm, up to 2^32
  /// world units. The result is deterministic. Throws as Frame::draw() does.
  std::vector<std::vector<ChunkVisibility>> measure(std::span<const shared::View> views,
                                                    const render::FrameSettings& settings,
                                                    const ModelChunks& chunks,
                                                    std::optional<int> shrink_most = {});

  /// Draws the view at full size, and keeps that picture.
  void keep_picture(const shared::View& view, const render::FrameSettings& settings);
  /// Draws the same view again and returns its squared difference from the kept picture, mean over pixels and
  /// channels.
  double picture_error(const shared::View& view, const render::FrameSettings& settings);

 private:
  std::vector<std::int64_t> sum_up(std::size_t views, int precision, const ModelChunks& chunks);

  render::Frame frame_;
  gl::Dispatcher dispatcher_;
  gl::Buffer sums_;  // alpha T^2 by splat: sums of the tiles' low VISIBILITY_LOW_BITS, and of the higher bits
  gl::Buffer owners_;  // chunk of each block, uint
  /// By view, then chunk: alpha T^2 in 64 bits, then alpha T^2 times the logarithm of the distance.
  gl::Buffer of_chunks_;
  render::SquaredError kept_;
};

}  // namespace binosplat
