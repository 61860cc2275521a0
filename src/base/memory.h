#pragma once
// This machine's memory.

#include <unistd.h>

namespace binosplat {

/// The machine's physical memory in bytes.
inline double memory_bytes() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// If a library crashes when memory is exhausted, ends the program with ExitCode::out_of_memory and a line:
/// OpenGL drivers do not check their allocations. Other crashes are unchanged. Only for `main`, because it
/// installs handlers for the process.
void end_cleanly_without_memory();

}  // namespace binosplat
