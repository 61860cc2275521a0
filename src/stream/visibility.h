#pragma once
// The visibility pass: what views show of the chunks of a model on the GPU. Levels of detail are chosen by it
// (stream/choice.h).

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
  /// Of a model that others draw, too; its context must be current in every call. Not of Scaffold-GS.
  explicit Visibility(std::shared_ptr<render::GpuModel> model);

  /// For each of the views what it shows of each chunk, which are the model's. Draws the views, smaller where
  /// they are large: by up to `shrink_most` along each axis, or what is fast, to pictures of at least 512 px.
  /// Of the settings count those of exact_of(), and the precision. Distances are means of the logarithm, over
  /// at most 2^32 world units. The same bits each time. Throws as Frame::draw() does.
  std::vector<std::vector<ChunkVisibility>> measure(std::span<const shared::View> views,
                                                    const render::FrameSettings& settings,
                                                    const ModelChunks& chunks,
                                                    std::optional<int> shrink_most = {});

  /// Draws the view in whole size, and keeps that picture.
  void keep_picture(const shared::View& view, const render::FrameSettings& settings);
  /// Draws the same view again: how far its picture is from the one that was kept, squared and meaned over
  /// pixels and channels.
  double picture_error(const shared::View& view, const render::FrameSettings& settings);

 private:
  std::vector<std::int64_t> sum_up(std::size_t views, int precision, const ModelChunks& chunks);

  render::Frame frame_;
  gl::Dispatcher dispatcher_;
  gl::Buffer sums_;    // by splat, alpha T^2: VISIBILITY_LOW_BITS of what tiles have, and those above
  gl::Buffer owners_;  // uint by block
  /// (view, chunk): 64 bits of alpha T^2, and of that times the logarithm of the distance.
  gl::Buffer of_chunks_;
  render::SquaredError kept_;
};

}  // namespace binosplat
