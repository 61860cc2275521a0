#pragma once
// Amounts (shared/types.h): how many things there are, for dispatches whose size may be known to the GPU
// only.

#include <cstdint>

#include "shared/limits.h"
#include "shared/types.h"

namespace binosplat::primitives {

/// The Amount of `count` things that begin at 0, as shared/amount.glsl fills it on the GPU; `block` of them
/// are sorted by a work group.
shared::Amount make_amount(std::uint32_t count, std::uint32_t groups_max, std::uint32_t block = SORT_BLOCK);

/// The two Amounts that the radix sort needs: of its keys, and of its counters, one a block and value of a
/// digit.
struct SortAmounts {
  shared::Amount keys;
  shared::Amount counters;
};
SortAmounts make_sort_amounts(std::uint32_t count, std::uint32_t digit_bits, std::uint32_t groups_max,
                              std::uint32_t block);

}  // namespace binosplat::primitives
