#pragma once
// Decodes the Gaussians of a Scaffold-GS model for an eye, in float64 (Lu et al. 2024). The judge of
// src/render/decode.cpp.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "reference/project.h"
#include "scene/scaffold.h"

namespace binosplat::reference {

/// The views that decode a model.
struct Decoding {
  /// Views that share Gaussians: the networks use the middle of their eyes. Empty: only the drawn view.
  std::vector<shared::View> views;
  bool anchor_cull = true;  // as trained; false: also decodes anchors out of view
};

/// A decoded Gaussian with positive opacity.
struct Decoded {
  std::size_t id = 0;  // n * K + k
  Gaussian gaussian;
  glm::dvec3 colour{0.0};
};

/// Whether a view sees an anchor: projects it as a Gaussian with its offsets' scales, whose 3-sigma square
/// must touch a tile of 16 x 16 px, as with TILES_AABB.
bool sees_anchor(const Scaffold& scaffold, std::size_t n, const shared::View& view);

/// The Gaussians with positive opacity of all anchors that any of `views` sees, in the order of their ids.
std::vector<Decoded> decode(const Scaffold& scaffold, std::span<const shared::View> views,
                            bool anchor_cull = true);

/// The splats of a view for a model of either kind, by index. Gaussians that are not decoded are not drawn.
std::vector<Splat> project_all(const Model& model, const shared::View& view, const Decoding& decoding,
                               const Perspective& perspective);

}  // namespace binosplat::reference
