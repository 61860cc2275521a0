#pragma once
// The Gaussians of a Scaffold-GS model as its networks make them for an eye, in float64 (Lu et al. 2024). The
// judge of src/render/decode.cpp.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "reference/project.h"
#include "scene/scaffold.h"

namespace binosplat::reference {

/// What decodes a model for a view.
struct Decoding {
  /// The views that share the Gaussians: the networks look from the middle of their eyes. Empty: the view
  /// by itself.
  std::vector<shared::View> views;
  bool anchor_cull = true;  // as trained; false: anchors out of view are decoded, too
};

/// A Gaussian that the networks keep.
struct Decoded {
  std::size_t id = 0;  // n * K + k
  Gaussian gaussian;
  glm::dvec3 colour{0.0};
};

/// Whether a view sees an anchor: as if it were a Gaussian of its offsets' scales, whose 3-sigma square
/// touches a tile of 16 x 16 px as with TILES_AABB.
bool sees_anchor(const Scaffold& scaffold, std::size_t n, const shared::View& view);

/// The Gaussians with an alpha above 0 of the anchors that any of `views` sees, in the order of their ids.
std::vector<Decoded> decode(const Scaffold& scaffold, std::span<const shared::View> views,
                            bool anchor_cull = true);

/// All Gaussians of a model of either kind in a view, by index; what is not decoded is not drawn.
std::vector<Splat> project_all(const Model& model, const shared::View& view, const Decoding& decoding,
                               const Perspective& perspective);

}  // namespace binosplat::reference
