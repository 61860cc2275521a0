#include "base/log.h"

#include <cstdio>

namespace binosplat {

void log_line(const std::string& text) {
  const std::string line = "binosplat: " + text + "\n";
  std::fwrite(line.data(), 1, line.size(), stderr);
}

}  // namespace binosplat
