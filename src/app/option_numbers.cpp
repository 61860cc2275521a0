#include "app/option_numbers.h"

#include <algorithm>
#include <limits>
#include <sstream>

#include "base/error.h"
#include "base/numbers.h"

namespace binosplat::app {

glm::dvec3 parse_three(const std::string& option, const std::string& text) {
  glm::dvec3 v{0.0};
  char comma_1 = 0, comma_2 = 0;
  std::istringstream in(text);
  in >> v.x >> comma_1 >> v.y >> comma_2 >> v.z;
  if (!in || comma_1 != ',' || comma_2 != ',' || in.peek() != std::istringstream::traits_type::eof()) {
    fail("{} {}: expected three numbers with commas, as in 1,-2.5,3", option, text);
  }
  return v;
}

glm::ivec2 parse_two(const std::string& option, const std::string& text, const char* expected) {
  const auto two = two_numbers(text, 'x');
  constexpr unsigned most = std::numeric_limits<int>::max();
  if (!two || std::min(two->first, two->second) < 1 || std::max(two->first, two->second) > most)
    fail("{} {}: expected {}", option, text, expected);
  return {two->first, two->second};
}

}  // namespace binosplat::app
