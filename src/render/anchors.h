#pragma once
// The buffers of a Scaffold-GS model (scene/scaffold.h) that the stage `decode` reads.

#include <cstdint>

#include "gl/buffer.h"
#include "scene/scaffold.h"

namespace binosplat::render {

/// The anchors of one page of the model.
struct AnchorBuffers {
  /// Uploads anchors [first, first + count).
  AnchorBuffers(gl::Context& context, const Scaffold& scaffold, std::size_t first, std::size_t count);

  std::uint32_t count = 0;
  gl::Buffer anchors;    // Anchor
  gl::Buffer offsets;    // float by (anchor, k below K, axis)
  gl::Buffer view_free;  // vec4 by (resolution, network, quad, anchor): scaffold_networks.glsl
};

/// The networks of a Scaffold-GS model; empty for other models.
struct NetworkBuffers {
  explicit NetworkBuffers(gl::Context& context) : weights(context, "networks") {}

  /// Uploads the networks. The colour network's bias includes the chosen appearance.
  void upload(const Scaffold& scaffold);

  gl::Buffer weights;        // vec4, see scaffold_networks.glsl
  std::int64_t bytes = 0;    // of the weights
  std::uint32_t hidden = 0;  // units of each network, rounded up to a multiple of four as in the shader
  bool bank = false;         // whether the model has a feature bank
};

/// Returns the bytes of the anchors on the GPU, including offsets and view_free.
std::int64_t anchor_bytes(const Scaffold& scaffold);

}  // namespace binosplat::render
