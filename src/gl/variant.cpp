#include "gl/variant.h"

#include <fmt/core.h>

#include <bit>
#include <limits>
#include <stdexcept>

namespace binosplat::gl {

std::uint64_t key_of(std::span<const Number> numbers) {
  std::uint64_t key = 0, keys = 1;
  for (const Number& n : numbers) {
    if (n.value >= n.count || keys > std::numeric_limits<std::uint64_t>::max() / n.count)
      throw std::logic_error(
          fmt::format("shader define {} = {}: expected less than {}", n.name, n.value, n.count));
    key = key * n.count + n.value;
    keys *= n.count;
  }
  return key;
}

Defines defines_of(std::span<const Number> numbers) {
  Defines defines;
  for (const Number& n : numbers) {
    if (n.is_real && n.value == 0) continue;
    defines.emplace_back(
        n.name, n.is_real ? fmt::format("{:.9g}", std::bit_cast<float>(static_cast<std::uint32_t>(n.value)))
                          : std::to_string(n.value));
    if (n.word != nullptr) defines.emplace_back(fmt::format("{}_NAME", n.name), n.word);
  }
  return defines;
}

}  // namespace binosplat::gl
