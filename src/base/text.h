#pragma once
// Letters in names.

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string>

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

}  // namespace binosplat
