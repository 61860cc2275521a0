#pragma once
// Lines for the user on standard error; standard output is kept for results.

#include <fmt/core.h>

#include <binosplat/error.h>
#include <string>
#include <utility>

namespace binosplat {

/// Writes `binosplat: TEXT` and a newline to standard error. Texts may quote files and libraries: control
/// characters but newlines, which could drive the terminal, come out as '?'.
void log_line(const std::string& text);

/// What set_quiet() said last.
bool is_quiet();

/// Something worth knowing: which device is used, what was left out, that a frame was drawn again.
template <typename... Args>
void log_info(fmt::format_string<Args...> format, Args&&... args) {
  if (!is_quiet()) log_line(fmt::format(format, std::forward<Args>(args)...));
}

/// Something that is probably not what the user meant.
template <typename... Args>
void log_warning(fmt::format_string<Args...> format, Args&&... args) {
  log_line("warning: " + fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace binosplat
