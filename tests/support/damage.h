#pragma once
// Damages files at random.

#include <string>

#include "support/models.h"

namespace binosplat::test {

/// Makes one to four random changes: flips or overwrites a byte, or overwrites bytes with a number that
/// readers may fail to handle; or cuts, inserts, removes or repeats bytes. `gently` uses only the first
/// three, near the end, where the values are, so that many files remain readable.
inline std::string damaged(std::string bytes, Uniform& uniform, bool gently = false) {
  const auto below = [&](std::size_t n) {
    return static_cast<std::size_t>(uniform(0, static_cast<double>(n)));
  };
  for (std::size_t steps = 1 + below(4); steps > 0 && !bytes.empty(); --steps) {
    // Headers are small, and half of the changes go there.
    const std::size_t quarter = 1 + (bytes.size() - 1) / 4;
    const std::size_t at =
        gently ? bytes.size() - 1 - below(quarter)
               : below(below(2) == 0 ? bytes.size() : std::min<std::size_t>(bytes.size(), 1000));
    const std::string hard[] = {
        "0", "-1", "4294967296", "18446744073709551615", "99999999999", "1e400", "nan", "{}", "[[[",
        "\xff\xff\xff\xff", "\xff\xff\xff\x7f", std::string(4, '\0'),
        // Infinity, NaN and 1e38 as floats.
        std::string("\0\0\x80\x7f", 4), std::string("\0\0\xc0\x7f", 4), "\x99\x76\x96\x7e"};
    const std::string& number = hard[below(std::size(hard))];
    switch (below(gently ? 3 : 7)) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 1:
        bytes[at] = static_cast<char>(below(256));
        break;
      case 2: {
        const std::size_t digit = bytes.find_first_of("0123456789", at);
        const std::size_t from = below(2) == 0 && digit != std::string::npos ? digit : at;
        bytes.replace(from, number.size(), number);
        break;
      }
      case 3:
        bytes.resize(at);
        break;
      case 4:
        bytes.insert(at, 1, "09-.e \n\r,:\""[below(11)]);
        break;
      case 5:
        bytes.erase(at, 1 + below(8));
        break;
      default:
        bytes.insert(at, bytes.substr(below(bytes.size()), 1 + below(64)));
    }
  }
  return bytes;
}

}  // namespace binosplat::test
