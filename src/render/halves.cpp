#include "render/halves.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/gtc/packing.hpp>

#include "scene/model.h"

namespace binosplat::render {

namespace {

constexpr float most = 65504.0f;
constexpr float least = 0x1p-14f;  // the smallest normal number of fp16

std::uint32_t pair(float a, float b) {
  return glm::packHalf2x16(glm::vec2(std::clamp(a, -most, most), std::clamp(b, -most, most)));
}

// A unit quaternion without its largest component: 20 bits for each of the others, and two for the index.
std::array<std::uint32_t, 2> pack_rotation(const glm::vec4& q) {
  int largest = 0;
  for (int k = 1; k < 4; ++k) largest = std::abs(q[k]) > std::abs(q[largest]) ? k : largest;
  const float steps_to_one = std::copysign(741454.0f, q[largest]);
  std::array<std::uint32_t, 3> steps{};
  auto step = steps.begin();
  for (int k = 0; k < 4; ++k) {
    if (k != largest)
      *step++ = static_cast<std::uint32_t>(
          std::clamp(std::round(q[k] * steps_to_one) + 524288.0f, 0.0f, 1048575.0f));
  }
  return {steps[0] | steps[1] << 20,
          steps[1] >> 12 | steps[2] << 8 | static_cast<std::uint32_t>(largest) << 28};
}

float rounded(float number) { return glm::unpackHalf2x16(pair(number, 0.0f)).x; }

std::uint32_t word(float number) { return std::bit_cast<std::uint32_t>(number); }

}  // namespace

Halves pack(const shared::Gaussian& g) {
  const float largest = std::max({g.scale.x, g.scale.y, g.scale.z});
  const glm::vec3 shares = glm::vec3(g.scale) / std::max(largest, 1e-37f);
  const auto rotation = pack_rotation(g.rotation);
  return {word(g.position.x),       word(g.position.y),           word(g.position.z), word(largest),
          pair(shares.x, shares.y), pair(shares.z, g.position.w), rotation[0],        rotation[1]};
}

Halves pack(const shared::Splat& s) {
  constexpr float factor = 256.0f;
  const float xx = std::sqrt(s.conic.x);
  const float yx = s.conic.y / xx;
  const float yy = 1.0f / (s.conic.w * xx);
  const float kept_xx = rounded(std::max(factor * xx, least));
  const float leaning = std::clamp(yx / xx * kept_xx, -most, most);
  return {word(s.mean.x),
          word(s.mean.y),
          word(s.depth),
          pair(s.colour.r, s.colour.g),
          pair(kept_xx, leaning),
          pair(std::copysign(std::max(factor * std::abs(yy), least), yy), s.opacity),
          pair(s.colour.b, leaning - rounded(leaning)),
          word(s.colour.w)};
}

void pack(std::span<const float> numbers, std::span<std::uint32_t> packed) {
  std::fill(packed.begin(), packed.end(), 0u);
  for (std::size_t k = 0; k < numbers.size(); k += 2)
    packed[k / 2] = pair(numbers[k], k + 1 < numbers.size() ? numbers[k + 1] : 0.0f);
}

std::int64_t harmonic_bytes(int degree, int precision) {
  const int in_a_word = precision == PRECISION_HALF ? 2 : 1;
  return (3 * sh_count(degree) + 4 * in_a_word - 1) / (4 * in_a_word) * 16;
}

}  // namespace binosplat::render
