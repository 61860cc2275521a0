#pragma once
// Parsers of option values. Each throws Error, which names the option, for other text.

#include <CLI/CLI.hpp>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "app/options/options.h"
#include "base/error.h"

namespace binosplat::app {

/// The lowest frame rate that --fps accepts.
constexpr double min_fps = 0.01;

glm::dvec3 parse_three(const std::string& option, const std::string& text);  // "1,-2.5,3"
/// Two numbers above zero, such as "1280x720". `expected` describes them.
glm::ivec2 parse_two(const std::string& option, const std::string& text, const char* expected);
double parse_ipd(const std::string& text);          // "0.064", "64mm"; returns m
double parse_convergence(const std::string& text);  // "2.5m", "inf"; returns m
std::string parse_axes(std::string text);           // "rdf"; returns upper case
Background parse_background(const std::string& text);
stereo::Foveation parse_foveation(const std::string& text);  // "inset=20deg,context=0.4,gaze=5,-3"
double parse_frame_budget(const std::string& text);          // milliseconds, or "auto": 0
/// The name of a motion, or "1.5,45": metres and degrees a second.
Motion parse_motion(const std::string& text);
Shard parse_shard(const std::string& text);  // "2/8"

/// The rules of --rule, as THRESHOLD,SOURCE or THRESHOLD, whose source is then the usual one: `depth` with
/// adagscale, else `one`.
std::vector<render::FrameSettings> rules_of(const std::vector<std::string>& texts);

/// Splits texts at commas. A text that is one name (`is_one`) stays whole, because names may contain commas.
template <typename IsOne>
std::vector<std::string> separated(const std::vector<std::string>& texts, const IsOne& is_one) {
  std::vector<std::string> names;
  for (const std::string& text : texts) {
    const std::vector<std::string> parts = is_one(text) ? std::vector{text} : CLI::detail::split(text, ',');
    names.insert(names.end(), parts.begin(), parts.end());
  }
  return names;
}

}  // namespace binosplat::app
