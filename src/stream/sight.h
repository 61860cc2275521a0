#pragma once
// What views show of the parts of a model: by it levels of detail are chosen (stream/detail.h).

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "render/frame.h"
#include "render/squared_error.h"
#include "scene/model_parts.h"

namespace binosplat {

class Sight {
 public:
  /// Of a model that others draw, too; its context must be current in every call. Not of Scaffold-GS.
  explicit Sight(std::shared_ptr<render::GpuModel> model);

  /// For each of the views what it shows of each part, which are the model's. Draws the views, smaller where
  /// they are large: by up to `shrink_most` along each axis, or what is fast, to pictures of at least 512 px.
  /// Of the settings count those of exact_of(), and the precision. Distances are means of the logarithm, over
  /// at most 2^32 world units. The same bits each time. Throws as Frame::draw() does.
  std::vector<std::vector<SeenPart>> look(std::span<const shared::View> views,
                                          const render::FrameSettings& settings, const ModelParts& parts,
                                          std::optional<int> shrink_most = {});

  /// The same of one view, and of its picture only what is in a band: areas of bands side by side add up to
  /// those of the picture, but for what is hidden, which counts in each, and as far as they are drawn at its
  /// size: narrow ones are larger.
  std::vector<SeenPart> look(const shared::View& view, Band band, const render::FrameSettings& settings,
                             const ModelParts& parts);

  /// By pictures of whole size, drawn exactly as those that are looked at; for as long as this one lives.
  PartsTrial trial(const render::FrameSettings& settings);

 private:
  int shrink_usual() const;
  std::vector<std::vector<SeenPart>> look(std::span<const shared::View> views,
                                          const render::FrameSettings& settings, const ModelParts& parts,
                                          int shrink_most, Band band);

  void draw_whole(const shared::View& view, const render::FrameSettings& settings);

  render::Frame frame_;
  gl::Dispatcher dispatcher_;
  gl::Buffer sums_;    // by splat, alpha T^2: SEEN_LOW_BITS of what tiles have, and those above
  gl::Buffer owners_;  // uint by block
  gl::Buffer
      of_parts_;  // (view, part): 64 bits of alpha T^2, and of that times the logarithm of the distance
  render::SquaredError kept_;  // a picture that was drawn whole
};

}  // namespace binosplat
