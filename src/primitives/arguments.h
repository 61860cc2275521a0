#pragma once
// Dispatch arguments (shared/types.h): how many things there are, for dispatches whose size may be known to
// the GPU only.

#include <cstdint>

#include "shared/limits.h"
#include "shared/types.h"

namespace binosplat::primitives {

/// The DispatchArguments of `count` things that begin at 0, as shared/arguments.glsl fills it on the GPU;
/// `block` of them are sorted by a work group.
shared::DispatchArguments make_arguments(std::uint32_t count, std::uint32_t groups_max,
                                         std::uint32_t block = SORT_BLOCK);

/// The two dispatch arguments that the radix sort needs: of its keys, and of its counters, one a block and
/// value of a digit.
struct SortArguments {
  shared::DispatchArguments keys;
  shared::DispatchArguments counters;
};
SortArguments make_sort_arguments(std::uint32_t count, std::uint32_t digit_bits, std::uint32_t groups_max,
                                  std::uint32_t block);

}  // namespace binosplat::primitives
