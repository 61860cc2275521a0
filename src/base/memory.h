#pragma once
// This machine's memory.

#include <unistd.h>

namespace binosplat {

/// All of it, in bytes.
inline double memory_bytes() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

}  // namespace binosplat
