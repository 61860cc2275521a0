#pragma once
// Checks and parsers of option values.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/numbers.h"
#include "render/settings.h"
#include "shared/axes.h"

namespace binosplat::app {

/// A number from `low` to `high`, both included; rejects "nan".
inline CLI::Validator between(double low, double high, const char* expected) {
  return CLI::Validator(
      [=](std::string& text) {
        double value = 0.0;
        const bool good = CLI::detail::lexical_cast(text, value) && value >= low && value <= high;
        return good ? std::string() : fmt::format("{}: expected {}", text, expected);
      },
      "");
}

/// Ranges in which numbers, and values computed from them, fit into a float.
inline const CLI::Validator positive = between(1e-30, 1e30, "a number above zero (1e-30 to 1e30)");
inline const CLI::Validator not_negative = between(0.0, 1e30, "a number from 0 to 1e30");
inline const CLI::Validator seconds_range = between(1e-6, 1e6, "seconds above zero (0.000001 to 1000000)");
constexpr double fps_least = 0.01;
inline const CLI::Validator fps_range =
    between(fps_least, 1000.0, "frames a second above zero (0.01 to 1000)");
inline const CLI::Validator quality_range =
    between(render::quality_least, render::quality_most, "decibels from 10 to 100");

/// An integer from 0 to 2^64 - 1. CLI11's own parser reads -1 as the largest one.
inline const CLI::Validator whole_number(
    [](std::string& text) {
      std::uint64_t value = 0;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
      const bool good = error == std::errc() && end == text.data() + text.size();
      return good ? std::string() : text + ": expected a whole number";
    },
    "");

template <typename Value>
using Words = std::vector<std::pair<std::string, Value>>;

/// The names of a list of shared/axes.h, with their indices as values. Omits the index `left_out`.
inline Words<int> words_of(std::span<const Choice> choices, int left_out = -1) {
  Words<int> words;
  for (int k = 0; k < static_cast<int>(choices.size()); ++k) {
    if (k != left_out) words.emplace_back(choices[static_cast<std::size_t>(k)].name, k);
  }
  return words;
}

/// Adds an option that takes one of the words and stores its value. Help lists the words.
template <typename Value, typename Into>
CLI::Option* choose(CLI::App& sub, const char* option, Into& into, const std::string& help,
                    const Words<Value>& words) {
  std::vector<std::string> names;
  for (const auto& [name, value] : words) names.push_back(name);
  const auto take = [&into, words](const std::string& given) {
    for (const auto& [name, value] : words) {
      if (name == given) into = value;
    }
  };
  return sub.add_option_function<std::string>(option, take, help)
      ->check(CLI::IsMember(names).description(""))
      ->type_name(fmt::format("{}", fmt::join(names, "|")));
}

/// The same for a list of shared/axes.h, with a line of help for each choice except `left_out`.
template <typename Into>
CLI::Option* choose_explained(CLI::App& sub, const char* option, Into& into, std::string help,
                              std::span<const Choice> choices, int left_out = -1) {
  const Words<int> words = words_of(choices, left_out);
  for (const auto& [name, k] : words)
    help += fmt::format("\n  {}: {}", name, choices[static_cast<std::size_t>(k)].help);
  return choose(sub, option, into, help, words);
}

/// Adds an option of one value, with a check.
template <typename Into>
CLI::Option* add_value(CLI::App& sub, const char* option, const char* type, Into& into,
                       const CLI::Validator& check, const std::string& help) {
  return sub.add_option(option, into, help)->type_name(type)->check(check);
}

/// Adds an option whose text `parse` converts. `parse` throws Error for bad text.
template <typename Into, typename Parse>
CLI::Option* add_parsed(CLI::App& sub, const char* option, const char* type, Into& into, Parse parse,
                        const std::string& help) {
  const auto take = [&into, parse](const std::string& text) { into = parse(text); };
  return sub.add_option_function<std::string>(option, take, help)->type_name(type);
}

/// Adds an option of names. It may be repeated, and a value may hold several names (separated()).
inline CLI::Option* add_names_option(CLI::App& sub, const char* option, std::vector<std::string>& into,
                                     const std::string& help, const char* type = "NAME") {
  return sub.add_option(option, into, help)
      ->type_name(type)
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

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

/// Parses "1,-2.5,3". Throws Error, naming the option, for other text.
inline glm::dvec3 parse_three(const std::string& option, const std::string& text) {
  glm::dvec3 v{0.0};
  char comma_1 = 0, comma_2 = 0;
  std::istringstream in(text);
  in >> v.x >> comma_1 >> v.y >> comma_2 >> v.z;
  if (!in || comma_1 != ',' || comma_2 != ',' || in.peek() != std::istringstream::traits_type::eof()) {
    fail("{} {}: expected three numbers with commas, as in 1,-2.5,3", option, text);
  }
  return v;
}

/// Parses "1280x720", with numbers above zero. Other text throws Error with the option and `expected`.
inline glm::ivec2 parse_two(const std::string& option, const std::string& text, const char* expected) {
  const auto two = two_numbers(text, 'x');
  constexpr unsigned most = std::numeric_limits<int>::max();
  if (!two || std::min(two->first, two->second) < 1 || std::max(two->first, two->second) > most)
    fail("{} {}: expected {}", option, text, expected);
  return {two->first, two->second};
}

/// Calls `work`, and puts `option` before the text of its Errors, since other rooms know no options.
template <typename Work>
auto naming(const std::string& option, const Work& work) try {
  return work();
} catch (const Error& error) {
  throw Error(error.code(), option + error.what());
}

inline CLI::Validator range(int low, int high) { return CLI::Range(low, high).description(""); }

inline CLI::Validator folder() { return CLI::Validator(CLI::ExistingDirectory).description(""); }

}  // namespace binosplat::app
