#include "base/choices.h"

#include <fmt/ranges.h>

#include <algorithm>

#include "base/error.h"

namespace binosplat {

std::vector<std::string> names_of(std::span<const Choice> choices) {
  std::vector<std::string> names;
  for (const Choice& choice : choices) names.emplace_back(choice.name);
  return names;
}

int find_choice(std::string_view place, std::string_view name, std::span<const Choice> choices) {
  const auto found =
      std::find_if(choices.begin(), choices.end(), [&](const Choice& c) { return c.name == name; });
  if (found == choices.end())
    fail("{}: '{}' is not one of {}", place, name, fmt::join(names_of(choices), ", "));
  return static_cast<int>(found - choices.begin());
}

}  // namespace binosplat
