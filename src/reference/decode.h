#pragma once
// Decodes the Gaussians of a Scaffold-GS model (Lu et al. 2024) for an eye, in float64. Tests compare
// src/render/decode.cpp by it.

#include <cstddef>
#include <vector>

#include "reference/project.h"
#include "scene/scaffold.h"

namespace binosplat::reference {

/// A decoded Gaussian with positive opacity.
struct Decoded {
  std::size_t id = 0;  // n * K + k, for Gaussian k of anchor n
  Gaussian gaussian;
  glm::dvec3 colour{0.0};
};

/// Whether a view sees anchor `n`: a Gaussian at the anchor, with the scales `offset_scale`, touches a tile
/// of 16 x 16 px by TILES_AABB.
bool sees_anchor(const Scaffold& scaffold, std::size_t n, const shared::View& view);

/// Returns the Gaussians with positive opacity, by ascending id, of all anchors that a view sees. Without
/// `anchor_cull`, which is as trained, of all anchors.
std::vector<Decoded> decode(const Scaffold& scaffold, const shared::View& view, bool anchor_cull = true);

/// Returns the splats of a view by index of their Gaussian, for Scaffold-GS and other models. Gaussians that
/// are not decoded are not `drawn`.
std::vector<Splat> project_all(const Model& model, const shared::View& view, bool anchor_cull,
                               const Perspective& perspective);

}  // namespace binosplat::reference
