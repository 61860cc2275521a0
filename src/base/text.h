#pragma once
// Text utilities: case, names, words and encodings.

#include <fmt/core.h>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace binosplat {

/// Converts ASCII capitals to lower case.
inline std::string lowered(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Returns a name's ending in lower case with its dot, as in ".png"; empty if the name has none.
inline std::string lowered_ending(const std::filesystem::path& path) {
  return lowered(path.extension().string());
}

/// Whether a name sorts before another, with numbers by value: "x9" before "x10".
bool natural_less(std::string_view a, std::string_view b);

/// Splits at blanks into at most `most` words; the last one is then the rest of the line, with its blanks.
std::vector<std::string_view> words_of(std::string_view line,
                                       std::size_t most = std::numeric_limits<std::size_t>::max());

/// Removes blanks and carriage returns at both ends.
inline std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  return text.substr(0, text.find_last_not_of(blanks) + 1);
}

/// Formats a coordinate for messages, with more digits if it is far from zero.
inline std::string coordinate(double value) {
  return fmt::format("{:.{}g}", value, std::abs(value) < 1e4 ? 4 : 10);
}

/// Joins words for a sentence, as in "a, b or c".
std::string alternatives(const std::vector<std::string>& words);

/// Encodes bytes as base64 (RFC 4648), padded by =.
std::string base64(std::string_view bytes);

}  // namespace binosplat
