#pragma once
// Throws Error, the only exception type of the project. `main` prints what() and returns code(). Also formats
// paths, which most errors name.

#include <fmt/core.h>

#include <binosplat/error.h>
#include <filesystem>
#include <utility>

/// A path in a text, without quotes.
template <>
struct fmt::formatter<std::filesystem::path> {
  constexpr auto parse(fmt::format_parse_context& context) { return context.begin(); }
  auto format(const std::filesystem::path& path, fmt::format_context& context) const {
    return fmt::format_to(context.out(), "{}", path.native());
  }
};

namespace binosplat {

/// Throws Error(bad_input) with a formatted text, for an unusable file, option or output.
template <typename... Args>
[[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) {
  throw Error(ExitCode::bad_input, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace binosplat
