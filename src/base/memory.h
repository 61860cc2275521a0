#pragma once
// This machine's memory.

#include <unistd.h>

namespace binosplat {

/// The machine's physical memory in bytes.
inline double memory_bytes() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// Installs handlers for crashes; only `main` may call it. OpenGL drivers do not check their allocations. If
/// memory is exhausted, the handlers report this and end the process with ExitCode::out_of_memory.
void end_cleanly_without_memory();

}  // namespace binosplat
