#pragma once
// Splats and views for tests of the reference, given in px.

#include <cmath>
#include <cstring>
#include <vector>

#include "reference/render.h"
#include "support/models.h"

namespace binosplat::reference {

inline shared::View view_of(int width, int height) {
  return make_view(test::front_camera(width, height, width));
}

/// A splat by its covariance in px^2 and mean in px.
inline Splat make_splat(const glm::dvec2& mean, const glm::dvec3& covariance, double opacity) {
  Splat splat;
  splat.mean = mean;
  splat.depth = splat.order = 1.0;
  splat.opacity = opacity;
  splat.covariance = covariance;
  splat.det = covariance.x * covariance.z - covariance.y * covariance.y;
  splat.conic = glm::dvec3(covariance.z, -covariance.y, covariance.x) / splat.det;
  splat.colour = glm::dvec3(1.0);
  splat.drawn = true;
  return splat;
}

/// Splats of many sizes, shapes, opacities and colours in and around a picture.
inline std::vector<Splat> random_splats(std::uint32_t seed, int count, int width, int height) {
  test::Uniform uniform(seed);
  std::vector<Splat> splats;
  for (int i = 0; i < count; ++i) {
    const double a = std::exp(uniform(-1.0, 3.5)), b = std::exp(uniform(-1.0, 3.5)), turn = uniform(0, M_PI);
    const double c = std::cos(turn), s = std::sin(turn);
    const glm::dvec3 covariance(a * a * c * c + b * b * s * s + 0.3, (a * a - b * b) * c * s,
                                a * a * s * s + b * b * c * c + 0.3);
    const double opacity = uniform(0, 1);
    Splat splat =
        make_splat({uniform(-30, width + 30), uniform(-30, height + 30)}, covariance, opacity * opacity);
    splat.depth = splat.order = uniform(1, 9);
    splat.colour = {uniform(0, 1), uniform(0, 1), uniform(0, 1)};
    splats.push_back(splat);
  }
  return splats;
}

inline bool equal_bits(const Picture& a, const Picture& b) {
  return a.colour.size() == b.colour.size() && a.z_sum.size() == b.z_sum.size() &&
         std::memcmp(a.colour.data(), b.colour.data(), a.colour.size() * sizeof(glm::vec4)) == 0 &&
         std::memcmp(a.z_sum.data(), b.z_sum.data(), a.z_sum.size() * sizeof(float)) == 0;
}

inline Picture picture_of(const std::vector<Splat>& splats, const shared::View& view, int tiles) {
  return blend(splats, make_lists(splats, depth_order(splats), view, tiles), view);
}

}  // namespace binosplat::reference
