#include "app/options/values.h"

#include <charconv>
#include <cstdint>

namespace binosplat::app {

CLI::Validator between(double low, double high, const std::string& expected) {
  return CLI::Validator(
      [=](std::string& text) {
        double value = 0.0;
        const bool good = CLI::detail::lexical_cast(text, value) && value >= low && value <= high;
        return good ? std::string() : fmt::format("{}: expected {}", text, expected);
      },
      "");
}

CLI::Validator positive() { return between(1e-30, 1e30, "a number above zero (1e-30 to 1e30)"); }
CLI::Validator not_negative() { return between(0.0, 1e30, "a number from 0 to 1e30"); }

CLI::Validator whole_number() {
  return CLI::Validator(
      [](std::string& text) {
        std::uint64_t value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        const bool good = error == std::errc() && end == text.data() + text.size();
        return good ? std::string() : text + ": expected a whole number";
      },
      "");
}

CLI::Validator existing_file() { return CLI::Validator(CLI::ExistingFile).description(""); }
CLI::Validator existing_folder() { return CLI::Validator(CLI::ExistingDirectory).description(""); }
CLI::Validator word_is(const char* word) { return CLI::Validator(CLI::IsMember({word})).description(""); }

}  // namespace binosplat::app
