#pragma once
// Small Scaffold-GS models with random weights.

#include <memory>
#include <utility>
#include <vector>

#include "scene/scaffold.h"
#include "support/models.h"

namespace binosplat::test {

struct ScaffoldKind {
  std::size_t anchors = 40;
  std::size_t offsets = 10;   // K
  std::size_t features = 32;  // F
  std::size_t hidden = 32;
  bool distances = false;       // the distance is an input of every network
  std::size_t appearances = 0;  // number of appearances, of 5 values each
  bool bank = false;
};

inline std::vector<float> random_values(Uniform& uniform, std::size_t count, double most) {
  std::vector<float> values(count);
  for (float& value : values) value = static_cast<float>(uniform(-most, most));
  return values;
}

inline Network random_network(Uniform& uniform, std::size_t inputs, std::size_t hidden, std::size_t outputs) {
  Network network{inputs, hidden, outputs};
  network.first = random_values(uniform, hidden * inputs, 0.5);
  network.first_bias = random_values(uniform, hidden, 0.5);
  network.second = random_values(uniform, outputs * hidden, 0.5);
  network.second_bias = random_values(uniform, outputs, 0.2);
  return network;
}

/// Returns anchors in front of front_camera(width, height, width), like random_model(): some beyond the
/// picture's edges, a few nearer than the near plane.
inline Scaffold random_scaffold(std::uint32_t seed, const ScaffoldKind& kind = {}) {
  Uniform uniform(seed);
  Scaffold s;
  s.name = "random";
  s.offset_count = kind.offsets;
  s.feature_count = kind.features;
  const auto three = [&](double low, double high) {
    return glm::vec3(uniform(low, high), uniform(low, high), uniform(low, high));
  };
  for (std::size_t n = 0; n < kind.anchors; ++n) {
    const double z = uniform(0.1, 6.0);
    s.position.emplace_back(uniform(-0.8, 0.8) * z, uniform(-0.8, 0.8) * z, z);
    s.offset_scale.push_back(glm::exp(three(-5.0, -2.0)));
    s.scale.push_back(glm::exp(three(-5.0, -1.5)));
    s.rotation.emplace_back(
        glm::normalize(glm::dvec4(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1))));
  }
  for (std::size_t i = 0; i < s.count(); ++i) s.offset.push_back(three(-1, 1));
  s.feature = random_values(uniform, kind.anchors * kind.features, 1.0);
  const std::size_t inputs = kind.features + 3 + (kind.distances ? 1 : 0);
  s.appearance_size = kind.appearances == 0 ? 0 : 5;
  s.appearances = random_values(uniform, kind.appearances * 5, 1.0);
  s.opacity = random_network(uniform, inputs, kind.hidden, kind.offsets);
  s.covariance = random_network(uniform, inputs, kind.hidden, 7 * kind.offsets);
  s.colour = random_network(uniform, inputs + s.appearance_size, kind.hidden, 3 * kind.offsets);
  s.opacity.distance = s.covariance.distance = s.colour.distance = kind.distances;
  if (kind.bank) {
    s.bank = random_network(uniform, 4, kind.features, 3);
    s.bank->distance = true;
  }
  return s;
}

/// Returns the model of random_scaffold().
inline Model scaffold_model(std::uint32_t seed, const ScaffoldKind& kind = {}) {
  return placeholder_model(std::make_shared<Scaffold>(random_scaffold(seed, kind)));
}

}  // namespace binosplat::test
