#pragma once
// What the values of options are checked by.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "base/choices.h"

namespace binosplat::app {

/// Finite and above zero; written so that "nan" and "inf" fail too.
inline const CLI::Validator positive(
    [](std::string& text) {
      double value = 0.0;
      const bool good = CLI::detail::lexical_cast(text, value) && value > 0.0 && std::isfinite(value);
      return good ? std::string() : text + ": expected a number above zero";
    },
    "");

/// From 0 to 2^64 - 1; CLI11 by itself would take -1 for the largest.
inline const CLI::Validator whole(
    [](std::string& text) {
      std::uint64_t value = 0;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
      const bool good = error == std::errc() && end == text.data() + text.size();
      return good ? std::string() : text + ": expected a whole number";
    },
    "");

/// A choice of words or numbers; the help names them as the option's type, and once is enough.
template <typename T>
CLI::Validator one_of(std::initializer_list<T> choices) {
  return CLI::IsMember(std::vector<T>(choices)).description("");
}

/// The names of a list of shared/axes.h, as a check and as the option's type.
inline CLI::Option* one_of(CLI::Option* option, std::span<const Choice> choices) {
  const std::vector<std::string> names = names_of(choices);
  return option->check(CLI::IsMember(names).description(""))
      ->type_name(fmt::format("{}", fmt::join(names, "|")));
}

/// The same of a new option, with lines of help.
inline CLI::Option* choose(CLI::App& sub, const char* option, std::string& into, std::string help,
                           std::span<const Choice> choices) {
  for (const Choice& choice : choices) help += fmt::format("\n  {}: {}", choice.name, choice.help);
  return one_of(sub.add_option(option, into, help), choices);
}

inline CLI::Validator range(int low, int high) { return CLI::Range(low, high).description(""); }

inline CLI::Validator folder() { return CLI::Validator(CLI::ExistingDirectory).description(""); }

}  // namespace binosplat::app
