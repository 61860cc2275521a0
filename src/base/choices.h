#pragma once
// The choices of shared/choices.h by name.

#include <binosplat/settings.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "shared/choices.h"

namespace binosplat {

inline std::vector<std::string> names_of(std::span<const Choice> choices) {
  std::vector<std::string> names;
  for (const Choice& choice : choices) names.emplace_back(choice.name);
  return names;
}

// The settings' values have the numbers of shared/choices.h (render/variants.cpp).
inline const char* name_of(Threshold value) { return threshold_choices[static_cast<int>(value)].name; }
inline const char* name_of(Transmittance value) {
  return transmittance_choices[static_cast<int>(value)].name;
}
inline const char* name_of(Order value) { return order_choices[static_cast<int>(value)].name; }
inline const char* name_of(Projection value) { return projection_choices[static_cast<int>(value)].name; }

/// Returns the value of a name. For an unknown name throws Error with `place` and the known names.
template <typename Value = int>
Value find_choice(std::string_view place, std::string_view name, std::span<const Choice> choices) {
  const auto found = std::ranges::find(choices, name, &Choice::name);
  if (found == choices.end())
    fail("{}: '{}' is not one of {}", place, name, fmt::join(names_of(choices), ", "));
  return static_cast<Value>(found - choices.begin());
}

}  // namespace binosplat
