#include "render/halves.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/gtc/packing.hpp>

namespace binosplat::render {

namespace {

constexpr float most = 65504.0f;
constexpr float least = 0x1p-14f;  // that keeps all its bits

std::uint32_t pair(float a, float b) {
  return glm::packHalf2x16(glm::vec2(std::clamp(a, -most, most), std::clamp(b, -most, most)));
}

std::uint32_t word(float number) { return std::bit_cast<std::uint32_t>(number); }

}  // namespace

Halves pack(const shared::Gaussian& g) {
  const float largest = std::max({g.scale.x, g.scale.y, g.scale.z});
  const glm::vec3 shares = glm::vec3(g.scale) / std::max(largest, 1e-37f);
  return {word(g.position.x),
          word(g.position.y),
          word(g.position.z),
          word(largest),
          pair(shares.x, shares.y),
          pair(shares.z, g.position.w),
          pair(g.rotation.x, g.rotation.y),
          pair(g.rotation.z, g.rotation.w)};
}

Halves pack(const shared::Splat& s) {
  constexpr float factor = 256.0f;
  const float xx = std::sqrt(s.conic.x);
  const float yx = s.conic.y / xx;
  const float yy = 1.0f / (s.conic.w * xx);
  return {word(s.mean.x),
          word(s.mean.y),
          word(s.depth),
          pair(s.colour.r, s.colour.g),
          pair(std::max(factor * xx, least), factor * yx),
          pair(std::max(factor * yy, least), s.opacity),
          pair(s.colour.b, 0.0f),
          word(s.colour.w)};
}

void pack(std::span<const float> numbers, std::span<std::uint32_t> packed) {
  std::fill(packed.begin(), packed.end(), 0u);
  for (std::size_t k = 0; k < numbers.size(); k += 2)
    packed[k / 2] = pair(numbers[k], k + 1 < numbers.size() ? numbers[k + 1] : 0.0f);
}

}  // namespace binosplat::render
