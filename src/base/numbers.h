#pragma once
// Parsers of numbers in text.

#include <charconv>
#include <optional>
#include <string_view>
#include <utility>

namespace binosplat {

/// Parses and removes the digits at the start of `text`; none without digits or above 32 bits.
inline std::optional<unsigned> take_number(std::string_view& text) {
  unsigned value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

/// Parses and removes a real number with sign and exponent; accepts "inf" and "nan".
inline std::optional<double> take_real(std::string_view& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

/// Parses a text that is only a real number, perhaps with a plus sign; none for other text.
inline std::optional<double> parse_real(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto value = take_real(text);
  return text.empty() ? value : std::nullopt;
}

/// Parses "1280x720" or "2/8": two numbers with `between` between them; none for other text.
inline std::optional<std::pair<unsigned, unsigned>> two_numbers(std::string_view text, char between) {
  const auto first = take_number(text);
  if (!first || text.empty() || text.front() != between) return std::nullopt;
  text.remove_prefix(1);
  const auto second = take_number(text);
  if (!second || !text.empty()) return std::nullopt;
  return std::pair(*first, *second);
}

}  // namespace binosplat
