#pragma once
// A Scaffold-GS model in memory (Lu et al., Scaffold-GS: Structured 3D Gaussians for View-Adaptive Rendering,
// 2024): anchors with features, and small networks that generate K Gaussians of each anchor for every eye.

#include <cstddef>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scene/model.h"

namespace binosplat {

/// Two layers: outputs = second * max(0, first * inputs + first_bias) + second_bias. The caller applies the
/// final activation (tanh, ...).
struct Network {
  std::size_t inputs = 0;
  std::size_t hidden = 0;
  std::size_t outputs = 0;
  std::vector<float> first;       // (hidden, inputs)
  std::vector<float> first_bias;  // (hidden)
  std::vector<float> second;      // (outputs, hidden)
  std::vector<float> second_bias;
  bool distance = false;  // the distance to the eye is also an input
};

/// Inputs of the three networks: feature (F), direction from the eye (3), the distance if the network takes
/// it, and, for the colour network, the appearance. Gaussian k of anchor n has the id n * K + k; its mean is
/// the same for every eye.
struct Scaffold {
  std::string name;
  std::size_t offset_count = 0;     // K: Gaussians of one anchor
  std::size_t feature_count = 0;    // F
  std::vector<glm::vec3> position;  // by anchor, world units
  // World units per unit of `offset`. The cull of anchors uses it as scale, with `rotation`.
  std::vector<glm::vec3> offset_scale;
  std::vector<glm::vec3> scale;     // the largest standard deviations of its Gaussians, world units
  std::vector<glm::vec4> rotation;  // unit quaternions (w, x, y, z)
  std::vector<glm::vec3> offset;    // (anchor, K), in offset_scale
  std::vector<float> feature;       // (anchor, F)
  Network opacity;                  // K outputs; tanh gives alpha; a Gaussian exists only if it is above 0
  Network covariance;  // 7 K outputs: 3 through a sigmoid, times scale; a quaternion (w, x, y, z)
  Network colour;      // 3 K outputs; sigmoid: RGB
  // The feature bank's network has direction and distance as inputs, and 3 outputs, through a softmax.
  std::optional<Network> bank;
  std::vector<float> appearances;   // (row, appearance_size)
  std::size_t appearance_size = 0;  // 0: colours use no appearance
  std::size_t appearance = 0;       // the row that colours use
  std::size_t left_out = 0;         // anchors of the source with values that are not finite

  std::size_t anchor_count() const { return position.size(); }
  std::size_t count() const { return anchor_count() * offset_count; }  // ids
  std::size_t appearance_count() const {
    return appearance_size == 0 ? 0 : appearances.size() / appearance_size;
  }
  glm::vec3 mean(std::size_t id) const {
    const std::size_t n = id / offset_count;
    return position[n] + offset[id] * offset_scale[n];
  }
};

/// Returns the model that draws, frames and repeats a Scaffold-GS scene: its Gaussians by id, at their means.
/// Scales, rotations and opacities are placeholders of typical size, since the true ones depend on the eye.
Model placeholder_model(std::shared_ptr<Scaffold> scaffold);

/// Describes the scaffold for display: "Scaffold-GS, 18290 anchors of 10 Gaussians, features of 32".
std::string describe(const Scaffold& scaffold);

/// Selects row `id` of the appearances for colours. Throws Error, naming `id`, if the row is missing.
void choose_appearance(Scaffold& scaffold, std::size_t id);

}  // namespace binosplat
