#pragma once
// Choices of shared/axes.h by their names.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/axes.h"

namespace binosplat {

/// The names of a list of shared/axes.h, in its order.
std::vector<std::string> names_of(std::span<const Choice> choices);

/// The number of a name of one of these lists. Throws Error, beginning with `place`, for a name that is not
/// in it; the text lists those that are.
int find_choice(std::string_view place, std::string_view name, std::span<const Choice> choices);

}  // namespace binosplat
