#pragma once
// Messages for the user on standard error; standard output has only results.

#include <map>
#include <string>
#include <utility>

#include "base/error.h"

namespace binosplat {

/// Returns the text that people read for one in which a module names settings, as in "a smaller `size`": the
/// same text. The programs replace this function, before other work, by with_options() of src/app.
inline std::string (*as_shown)(std::string text) = [](std::string text) { return text; };

/// Writes `binosplat: TEXT`, as shown, and a newline to standard error. Replaces control characters except
/// newlines by '?', because text from files and libraries could otherwise control the terminal.
void log_line(const std::string& text);

bool is_quiet();

/// Reports useful facts: the device, omissions, repeated frames.
template <typename... Args>
void log_info(fmt::format_string<Args...> format, Args&&... args) {
  if (!is_quiet()) log_line(fmt::format(format, std::forward<Args>(args)...));
}

/// While it exists, warnings of this thread wait. Its end writes equal ones as one line with their number.
struct WarningsOnce {
  ~WarningsOnce();
  static inline thread_local WarningsOnce* waiting = nullptr;
  WarningsOnce* const outer = std::exchange(waiting, this);
  std::map<std::string, int> numbers = {};  // by text
};

/// Reports a probable mistake of the user.
template <typename... Args>
void log_warning(fmt::format_string<Args...> format, Args&&... args) {
  std::string text = fmt::format(format, std::forward<Args>(args)...);
  if (WarningsOnce::waiting == nullptr) return log_line("warning: " + text);
  ++WarningsOnce::waiting->numbers[std::move(text)];
}

}  // namespace binosplat
