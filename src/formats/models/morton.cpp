#include "formats/models/morton.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"
#include "base/parallel_sort.h"

namespace binosplat {

namespace {

constexpr int morton_bits = 21;

/// Spreads the bits of a 21-bit number: inserts two zeros between neighbouring bits.
std::uint64_t spread(std::uint64_t v) {
  v = (v | v << 32) & 0x001f00000000ffff;
  v = (v | v << 16) & 0x001f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  return (v | v << 2) & 0x1249249249249249;
}

}  // namespace

std::vector<std::uint32_t> morton_order(std::span<const glm::vec3> positions) {
  if (positions.empty()) return {};
  glm::dvec3 low(positions[0]), high(low);
  for (const glm::vec3& p : positions) {
    low = glm::min(low, glm::dvec3(p));
    high = glm::max(high, glm::dvec3(p));
  }
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(positions.size());
  parallel_for(keys.size(), [&](std::size_t i) {
    std::uint64_t key = 0;
    for (int c = 0; c < 3; ++c) {
      const double extent = high[c] - low[c];
      const double fraction = extent > 0.0 ? (positions[i][c] - low[c]) / extent : 0.0;
      key |= spread(static_cast<std::uint64_t>(fraction * ((1 << morton_bits) - 1))) << c;
    }
    keys[i] = {key, static_cast<std::uint32_t>(i)};
  });
  parallel_sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order(keys.size());
  std::transform(keys.begin(), keys.end(), order.begin(), [](const auto& key) { return key.second; });
  return order;
}

}  // namespace binosplat
