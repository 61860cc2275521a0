#include "primitives/arguments.h"

#include <algorithm>

namespace binosplat::primitives {

namespace {

std::uint32_t blocks_of(std::uint32_t count, std::uint32_t block) {
  return count / block + (count % block != 0 ? 1 : 0);
}

void split(std::uint32_t groups, std::uint32_t groups_max, std::uint32_t& x, std::uint32_t& y,
           std::uint32_t& z) {
  y = groups == 0 ? 1 : (groups + groups_max - 1) / groups_max;
  x = (groups + y - 1) / y;
  z = 1;
}

}  // namespace

shared::DispatchArguments make_arguments(std::uint32_t count, std::uint32_t groups_max, std::uint32_t block) {
  shared::DispatchArguments a{};
  a.count = count;
  split(blocks_of(count, THREADS), groups_max, a.threads_x, a.threads_y, a.threads_z);
  split(std::max(1u, blocks_of(count, SCAN_BLOCK)), groups_max, a.scan_x, a.scan_y, a.scan_z);
  split(blocks_of(count, block), groups_max, a.sort_x, a.sort_y, a.sort_z);
  return a;
}

SortArguments make_sort_arguments(std::uint32_t count, std::uint32_t digit_bits, std::uint32_t groups_max,
                                  std::uint32_t block) {
  return {make_arguments(count, groups_max, block),
          make_arguments(blocks_of(count, block) << digit_bits, groups_max)};
}

}  // namespace binosplat::primitives
