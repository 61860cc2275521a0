#pragma once
// Small models and cameras for tests. Their values are those that are drawn: no logarithms, logits or SH
// constants.

#include <cstdint>
#include <glm/glm.hpp>
#include <random>

#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat::test {

/// Appends a Gaussian as trainers store it, or counts it as left out. Returns whether it was appended.
inline bool append_raw(Model& model, const GaussianValues& raw) {
  const std::size_t i = model.count();
  model.resize(i + 1);
  if (decode_raw(model, i, raw)) return true;
  model.resize(i);
  ++model.left_out;
  return false;
}

constexpr double sh_c0 = 0.28209479177387814;

/// Appends a Gaussian that has the same colour from all sides: its SH above degree 0 are 0.
inline void add(Model& model, const glm::vec3& position, const glm::vec3& scale, float opacity,
                const glm::vec3& colour = glm::vec3(1.0f), const glm::vec4& rotation = {1, 0, 0, 0}) {
  model.position.push_back(position);
  model.scale.push_back(scale);
  model.rotation.emplace_back(glm::normalize(glm::dvec4(rotation)));
  model.opacity.push_back(opacity);
  for (int c = 0; c < 3; ++c) model.sh.push_back(static_cast<float>((colour[c] - 0.5) / sh_c0));
  model.sh.resize(model.count() * 3 * static_cast<std::size_t>(sh_count(model.degree)));
}

/// A camera at the origin that looks along z, x right and y down, with a centred principal point.
inline Camera front_camera(int width, int height, double focal) {
  Camera camera;
  camera.name = "front";
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = focal;
  camera.cx = width / 2.0;
  camera.cy = height / 2.0;
  return camera;
}

/// Uniform random numbers that are equal with every standard library.
class Uniform {
 public:
  explicit Uniform(std::uint32_t seed) : engine_(seed) {}
  double operator()(double low, double high) { return low + (high - low) * (engine_() * 0x1p-32); }

 private:
  std::mt19937 engine_;
};

/// Returns Gaussians of many sizes, shapes, opacities and colours in front of front_camera(width, height,
/// width). Most lie within the picture, some beyond its edges. A few are nearer than the near plane, and some
/// are fainter than tau.
inline Model random_model(std::uint32_t seed, int count, int degree, double height_over_width = 1.0) {
  Uniform uniform(seed);
  Model model;
  model.name = "random";
  model.degree = degree;
  for (int i = 0; i < count; ++i) {
    const double z = uniform(0.1, 6.0);
    const glm::vec3 position(uniform(-0.65, 0.65) * z, uniform(-0.65, 0.65) * z * height_over_width, z);
    const auto scale = [&] { return std::exp(uniform(-6.0, -1.5)); };
    const glm::vec3 scales(scale(), scale(), scale());
    const glm::vec4 rotation(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    const double opacity = uniform(0, 1);
    const glm::vec3 colour(uniform(0, 1), uniform(0, 1), uniform(0, 1));
    add(model, position, scales, static_cast<float>(opacity * opacity), colour, rotation);
    const std::size_t values = 3 * static_cast<std::size_t>(sh_count(degree));
    for (std::size_t k = 3; k < values; ++k)
      model.sh[i * values + k] = static_cast<float>(uniform(-0.2, 0.2));
  }
  return model;
}

}  // namespace binosplat::test
