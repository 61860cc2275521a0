#pragma once
// Kinds of option values: how a text is checked and where it is stored.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "app/options/table.h"
#include "base/numbers.h"
#include "shared/choices.h"

namespace binosplat::app {

/// A number from `low` to `high`, both included; rejects "nan".
CLI::Validator between(double low, double high, const std::string& expected);
inline CLI::Validator range(int low, int high) { return CLI::Range(low, high).description(""); }
/// Ranges in which numbers, and values computed from them, fit into a float.
CLI::Validator positive();
CLI::Validator not_negative();
/// An integer from 0 to 2^64 - 1. CLI11's own parser reads -1 as the largest one.
CLI::Validator whole_number();
CLI::Validator existing_file();
CLI::Validator existing_folder();
CLI::Validator word_is(const char* word);

/// A value that CLI11 parses.
template <typename Into>
Value value(const std::string& type, Into& into, const CLI::Validator& check = {}) {
  return {type, [&into, check](CLI::App& sub, const std::string& name) {
            return sub.add_option(name, into)->check(check);
          }};
}

/// A value that `parse` makes of its text. `parse` throws Error for bad text.
template <typename Into, typename Parse>
Value parsed(const std::string& type, Into& into, Parse parse) {
  return {type, [&into, parse](CLI::App& sub, const std::string& name) {
            return sub.add_option_function<std::string>(
                name, [&into, parse](const std::string& text) { into = parse(text); });
          }};
}

template <typename Kind>
using Words = std::vector<std::pair<std::string, Kind>>;

/// Stores a value, which may be the number of an enumerator.
template <typename Kind, typename Into>
void store(const Kind& kind, Into& into) {
  into = static_cast<Into>(kind);
}
template <typename Kind, typename Into>
void store(const Kind& kind, std::optional<Into>& into) {
  into = static_cast<Into>(kind);
}

/// One of the words, of which the index or another value is stored.
template <typename Kind, typename Into>
Value one_of(Into& into, const Words<Kind>& words) {
  std::vector<std::string> names;
  for (const auto& [name, kind] : words) names.push_back(name);
  return {fmt::format("{}", fmt::join(names, "|")),
          [&into, words, names](CLI::App& sub, const std::string& name) {
            return sub
                .add_option_function<std::string>(name,
                                                  [&into, words](const std::string& given) {
                                                    for (const auto& [word, kind] : words)
                                                      if (word == given) store(kind, into);
                                                  })
                ->check(CLI::IsMember(names).description(""));
          }};
}

/// One of the choices of shared/choices.h but `left_out`, of which the index is stored. Help explains each.
template <typename Into>
Value one_of(Into& into, std::span<const Choice> choices, int left_out = -1) {
  Words<int> words;
  std::string lines;
  for (int k = 0; k < static_cast<int>(choices.size()); ++k) {
    if (k == left_out) continue;
    words.emplace_back(choices[static_cast<std::size_t>(k)].name, k);
    lines += fmt::format("\n  {}: {}", words.back().first, choices[static_cast<std::size_t>(k)].help);
  }
  Value result = one_of<int>(into, words);
  result.choices = lines;
  return result;
}

/// A flag without value, which calls `act`.
template <typename Act>
Value action(Act act) {
  return {"", [act](CLI::App& sub, const std::string& name) { return sub.add_flag_callback(name, act); }};
}
inline Value flag(bool& into) {
  return action([&into] { into = true; });
}

/// Names. The option may be repeated, and a value may hold several names (separated()).
inline Value names(const std::string& type, std::vector<std::string>& into) {
  return {type, [&into](CLI::App& sub, const std::string& name) {
            return sub.add_option(name, into)
                ->expected(1)
                ->allow_extra_args(false)
                ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
          }};
}

}  // namespace binosplat::app
