#include "app/options/parse.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <string_view>
#include <utility>

#include "app/command_line.h"
#include "base/choices.h"
#include "base/error.h"
#include "base/numbers.h"
#include "base/text.h"
#include "scene/axes.h"

namespace binosplat::app {

namespace {

// Parses a length into metres. A number without unit is in metres.
double parse_length(const char* option, const std::string& text, const char* examples) {
  std::string_view unit = text;
  if (unit.starts_with("+")) unit.remove_prefix(1);
  const std::optional<double> value = take_real(unit);
  if (!value || !std::isfinite(*value))
    fail("{} {}: expected metres, or a number with a unit, {}", option, text, examples);
  if (unit == "mm") return 1e-3 * *value;
  if (unit == "cm") return 1e-2 * *value;
  if (!unit.empty() && unit != "m") fail("{} {}: its unit may be m, cm or mm", option, text);
  return *value;
}

// The words of --foveate, and the numbers that each expects.
constexpr std::pair<const char*, const char*> foveate_words[] = {
    {"inset", "degrees, as in inset=20deg"},
    {"context", "a share of the pixels along an axis, as in context=0.4"},
    {"gaze", "degrees to the right and up, as in gaze=10,-5"},
    {"seam", "a share of the inset, as in seam=0.1"}};

const char* numbers_of(const std::string& word, const std::string& text) {
  std::vector<std::string> words;
  for (const auto& [name, numbers] : foveate_words) {
    if (name == word) return numbers;
    words.emplace_back(name);
  }
  fail("--foveate {}: there is no {}{}; it takes {}", text, word, suggestion(word, words),
       fmt::join(words, ", "));
}

/// Parses THRESHOLD or THRESHOLD,SOURCE.
render::FrameSettings rule_of(const std::string& text) {
  std::string bare = text;
  std::erase(bare, ' ');
  const std::size_t comma = bare.find(',');
  const std::string place = "--rule " + text;
  render::FrameSettings rule;
  rule.threshold = find_choice<Threshold>(place, bare.substr(0, comma), threshold_choices);
  if (render::is_exact(*rule.threshold)) fail("{}: it is exact, and has no tolerance", place);
  rule.transmittance = render::usual_source(*rule.threshold);
  if (comma != std::string::npos)
    rule.transmittance = find_choice<Transmittance>(place, bare.substr(comma + 1), transmittance_choices);
  return rule;
}

}  // namespace

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

double parse_ipd(const std::string& text) {
  // A bare number above 1 probably means millimetres.
  constexpr double most = 1.0;
  const double metres = parse_length("--ipd", text, "as in 0.064, 64mm or 3m");
  if (!text.ends_with("m") && std::abs(metres) > most)
    fail("--ipd {0} means {0} m, but eyes are 0.063 m apart: give {0}mm, or {0}m for metres", text);
  if (metres < 0.0) fail("--ipd {}: expected metres, zero or more", text);
  return metres;
}

double parse_convergence(const std::string& text) {
  const std::string word = lowered(text.substr(text.starts_with("+") ? 1 : 0));
  if (word == "inf" || word == "infinity") return std::numeric_limits<double>::infinity();
  const double metres = parse_length("--convergence", text, "as in 3, 80cm or 2.5m, or inf");
  if (!(metres > 0.0)) fail("--convergence {}: expected metres above zero, or inf for parallel eyes", text);
  return metres;
}

std::string parse_axes(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  world_from_axes(text);
  return text;
}

Background parse_background(const std::string& text) {
  if (text == "none") return std::nullopt;
  const glm::dvec3 rgb = parse_three("--background", text);
  for (int i = 0; i < 3; ++i) {
    if (!(rgb[i] >= 0.0 && rgb[i] <= 1.0))
      fail("--background {}: expected numbers from 0 to 1, or none", text);
  }
  return glm::vec3(rgb);
}

stereo::Foveation parse_foveation(const std::string& text) {
  std::map<std::string, std::vector<double>> given;
  std::string word;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ',');) {
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos && word != "gaze")  // the only word with several numbers
      fail("--foveate {}: '{}': expected WORD=NUMBER, as in inset=20deg,context=0.4", text, part);
    if (equals != std::string::npos) {
      word = part.substr(0, equals);
      part.erase(0, equals + 1);
      if (given.contains(word)) fail("--foveate {}: {} is given twice", text, word);
    }
    const char* const expected = numbers_of(word, text);
    std::string_view number = part;
    if (word == "inset" && number.ends_with("deg")) number.remove_suffix(3);
    const std::optional<double> value = take_real(number);
    if (!value || !number.empty()) fail("--foveate {}={}: expected {}", word, part, expected);
    given[word].push_back(*value);
  }
  const std::vector<double>& gaze = given["gaze"];
  if (gaze.size() % 2 != 0 || gaze.size() > 4) {
    fail(
        "--foveate gaze={}: expected degrees to the right and up, as in gaze=10,-5, or those of the left and "
        "then of the right eye, as in gaze=10,-5,9,-5",
        fmt::join(gaze, ","));
  }
  stereo::Foveation out;
  const auto take = [&](const char* name, double& into) {
    if (given.contains(name)) into = given[name][0];
  };
  take("inset", out.inset_degrees);
  take("context", out.context_scale);
  take("seam", out.seam);
  for (std::size_t k = 0; k < gaze.size(); k += 2) out.gaze.emplace_back(gaze[k], gaze[k + 1]);
  stereo::check(out, "--foveate ");
  return out;
}

double parse_frame_budget(const std::string& text) {
  double ms = 0.0;
  const bool good = text == "auto" || (CLI::detail::lexical_cast(text, ms) && ms > 0.0 && ms <= 1000.0);
  if (!good) fail("--frame-budget {}: expected milliseconds above 0, at most 1000, or auto", text);
  return ms;
}

Motion parse_motion(const std::string& text) {
  std::vector<std::string> names;
  for (const Motion& motion : head_motions()) {
    if (motion.name == text) return motion;
    names.push_back(motion.name);
  }
  Motion motion{text};
  char comma = 0;
  std::istringstream in(text);
  in >> motion.metres_per_second >> comma >> motion.degrees_per_second;
  if (!in || comma != ',' || in.peek() != std::istringstream::traits_type::eof() ||
      !(motion.metres_per_second > 0.0) || !(motion.degrees_per_second > 0.0)) {
    fail("--tour {}: expected {}, or metres and degrees a second above 0, as in 1.5,45", text,
         fmt::join(names, ", "));
  }
  return motion;
}

Shard parse_shard(const std::string& text) {
  const auto shard = two_numbers(text, '/');
  if (shard && shard->first >= 1 && shard->first <= shard->second) return {shard->first - 1, shard->second};
  fail("--shard {}: expected I/N with I from 1 to N, as in 2/8", text);
}

std::vector<render::FrameSettings> rules_of(const std::vector<std::string>& texts) {
  std::vector<render::FrameSettings> rules;
  for (const std::string& text : texts) rules.push_back(rule_of(text));
  return rules;
}

}  // namespace binosplat::app
