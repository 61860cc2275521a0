#pragma once
// Errors that end a command. Their text is for the user: it names the file, the place in it, what was
// expected and what to do.

#include <fmt/core.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace binosplat {

/// The program's exit codes.
enum class ExitCode { done = 0, fell_short = 1, bad_input = 2, no_gl = 3, out_of_memory = 4 };

/// The one exception type of the project; `main` prints what() and returns code().
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& text) : std::runtime_error(text), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

/// Throws Error(bad_input) with a formatted text: a file, an option or an output that cannot be used.
template <typename... Args>
[[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) {
  throw Error(ExitCode::bad_input, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace binosplat
