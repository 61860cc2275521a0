#include "app/foveate_options.h"

#include <map>

#include "app/command_line.h"
#include "app/option_checks.h"
#include "base/error.h"
#include "base/numbers.h"

namespace binosplat::app {

namespace {

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

// Parses "inset=20deg,context=0.4,gaze=5,-3"; other members keep the defaults of stereo::Foveation. Throws
// Error, naming --foveate, for wrong syntax and for impossible numbers.
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

}  // namespace

void add_foveate_option(CLI::App& sub, std::optional<stereo::Foveation>& foveate) {
  add_parsed(sub, "--foveate", "inset=DEGREES,context=SHARE,...", foveate, parse_foveation,
             "Draw exactly an inset about the gaze, in degrees across, and the\ncontext around it with a "
             "share of the pixels along each axis:\ninset=20deg,context=0.4; gaze=RIGHT,UP: degrees from "
             "straight ahead\n(0,0), or those of both eyes; seam: a share of the inset (0.1).\n--tolerance "
             "is for the context")
      ->group("Drawing");
}

}  // namespace binosplat::app
