#include "app/foveate_options.h"

#include "app/command_line.h"
#include "app/option_checks.h"
#include "base/error.h"
#include "base/numbers.h"

namespace binosplat::app {

namespace {

const std::vector<std::string> foveate_words = {"inset", "context", "gaze", "seam"};

double number_of_word(std::string_view text, const std::string& word, const char* expected) {
  std::string_view rest = text;
  const std::optional<double> value = take_real(rest);
  if (!value || !rest.empty()) fail("--foveate {}={}: expected {}", word, text, expected);
  return *value;
}

// A word and its numbers, of which a gaze has several.
struct Entry {
  std::string word;
  std::vector<std::string> values;
};

std::vector<Entry> entries_of(const std::string& text) {
  std::vector<Entry> entries;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ',');) {
    const std::size_t equals = part.find('=');
    if (equals != std::string::npos) {
      entries.push_back({part.substr(0, equals), {part.substr(equals + 1)}});
    } else if (!entries.empty() && entries.back().word == "gaze") {
      entries.back().values.push_back(part);
    } else {
      fail("--foveate {}: '{}' is no WORD=NUMBER, as in inset=20deg,context=0.4", text, part);
    }
  }
  return entries;
}

// "inset=20deg,context=0.4,gaze=5,-3": what is not named is as stereo::Foveation has it. Throws Error, naming
// --foveate, for what cannot be understood and for numbers that no eye has.
stereo::Foveation parse_foveation(const std::string& text) {
  stereo::Foveation out;
  std::vector<std::string> seen;
  for (const Entry& entry : entries_of(text)) {
    if (std::ranges::find(foveate_words, entry.word) == foveate_words.end()) {
      fail("--foveate {}: there is no {}{}; it takes {}", text, entry.word,
           suggestion(entry.word, foveate_words), fmt::join(foveate_words, ", "));
    }
    if (std::ranges::find(seen, entry.word) != seen.end())
      fail("--foveate {}: {} is given twice", text, entry.word);
    seen.push_back(entry.word);
    const std::string& value = entry.values[0];
    if (entry.word == "inset") {
      std::string_view degrees = value;
      if (degrees.ends_with("deg")) degrees.remove_suffix(3);
      out.inset_degrees = number_of_word(degrees, entry.word, "degrees, as in inset=20deg");
    } else if (entry.word == "context") {
      out.context_scale =
          number_of_word(value, entry.word, "a share of the pixels along an axis, as in context=0.4");
    } else if (entry.word == "seam") {
      out.seam = number_of_word(value, entry.word, "a share of the inset, as in seam=0.1");
    } else {
      if (entry.values.size() != 2 && entry.values.size() != 4) {
        fail(
            "--foveate gaze={}: expected degrees to the right and up, as in gaze=10,-5, or those of the left "
            "and then of the right eye, as in gaze=10,-5,9,-5",
            fmt::join(entry.values, ","));
      }
      const auto degrees = [&](std::size_t k) {
        return number_of_word(entry.values[k], "gaze", "degrees to the right and up, as in gaze=10,-5");
      };
      for (std::size_t k = 0; k < entry.values.size(); k += 2)
        out.gaze.emplace_back(degrees(k), degrees(k + 1));
    }
  }
  stereo::check(out, "--foveate ");
  return out;
}

}  // namespace

void add_foveate_option(CLI::App& sub, std::optional<stereo::Foveation>& foveate) {
  add_parsed(
      sub, "--foveate", "inset=DEGREES,context=SHARE,...", foveate, parse_foveation,
      "Draw exactly an inset of so many degrees across where the eyes look, and\naround it a share of the "
      "pixels along each axis: inset=20deg,context=0.4;\ngaze=RIGHT,UP, degrees from straight ahead "
      "(0,0), or those of both eyes;\nseam, of the inset (0.1). --tolerance is for what lies around")
      ->group("Drawing");
}

}  // namespace binosplat::app
