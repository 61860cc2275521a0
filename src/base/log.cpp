#include "base/log.h"

#include <algorithm>
#include <atomic>
#include <cstdio>

namespace binosplat {

namespace {
std::atomic<bool> quiet_all = false;
}

WarningsOnce::~WarningsOnce() {
  waiting = outer;
  for (const auto& [text, number] : numbers)
    log_warning("{}{}", text, number == 1 ? "" : fmt::format(" ({} times)", number));
}

void set_quiet(bool quiet) { quiet_all = quiet; }

bool is_quiet() { return quiet_all; }

void log_line(const std::string& text) {
  const auto control = [](char c) { return (static_cast<unsigned char>(c) < ' ' && c != '\n') || c == 127; };
  std::string line = "binosplat: " + as_shown(text) + "\n";
  std::replace_if(line.begin(), line.end(), control, '?');
  std::fwrite(line.data(), 1, line.size(), stderr);
}

}  // namespace binosplat
