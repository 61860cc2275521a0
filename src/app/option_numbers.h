#pragma once
// Options whose value is several numbers.

#include <glm/glm.hpp>
#include <string>

namespace binosplat::app {

/// "1,-2.5,3". Throws Error, naming the option, for anything else.
glm::dvec3 parse_three(const std::string& option, const std::string& text);

/// "1280x720", both above zero. Throws Error, naming the option, for anything else; `expected` says what they
/// mean.
glm::ivec2 parse_two(const std::string& option, const std::string& text, const char* expected);

}  // namespace binosplat::app
