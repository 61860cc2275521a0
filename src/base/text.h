#pragma once
// Letters in names, and bytes as letters.

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

/// ASCII's capitals as small letters.
inline std::string lowered(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// A name's ending with its dot, as in ".png"; empty where there is none.
inline std::string lowered_ending(const std::filesystem::path& path) {
  return lowered(path.extension().string());
}

/// Whether a name comes before another one, the numbers in them by their size: "x9" before "x10".
bool comes_before(std::string_view a, std::string_view b);

/// What stands between blanks; the last of `most` words is all that is left, with the blanks in it.
std::vector<std::string_view> words_of(std::string_view line,
                                       std::size_t most = std::numeric_limits<std::size_t>::max());

/// A coordinate for people, of more digits in a far world.
inline std::string coordinate(double value) {
  return fmt::format("{:.{}g}", value, std::abs(value) < 1e4 ? 4 : 10);
}

/// Words for a sentence, as in "a, b or c".
std::string alternatives(const std::vector<std::string>& words);

/// Bytes as base64 (RFC 4648), filled up by =.
std::string base64(std::string_view bytes);

}  // namespace binosplat
