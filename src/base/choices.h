#pragma once
// The choices of shared/axes.h by name.

#include <fmt/ranges.h>

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "shared/axes.h"

namespace binosplat {

inline std::vector<std::string> names_of(std::span<const Choice> choices) {
  std::vector<std::string> names;
  for (const Choice& choice : choices) names.emplace_back(choice.name);
  return names;
}

/// Returns the index of a name. For an unknown name throws Error with `place` and the known names.
inline int find_choice(std::string_view place, std::string_view name, std::span<const Choice> choices) {
  const auto found = std::ranges::find(choices, name, &Choice::name);
  if (found == choices.end())
    fail("{}: '{}' is not one of {}", place, name, fmt::join(names_of(choices), ", "));
  return static_cast<int>(found - choices.begin());
}

}  // namespace binosplat
