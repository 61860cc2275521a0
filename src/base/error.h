#pragma once
// Throws Error, the only exception type of the project. `main` prints what() and returns code().

#include <fmt/core.h>

#include <binosplat/error.h>
#include <string>
#include <utility>

namespace binosplat {

/// Throws Error(bad_input) with a formatted text, for an unusable file, option or output.
template <typename... Args>
[[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) {
  throw Error(ExitCode::bad_input, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace binosplat
