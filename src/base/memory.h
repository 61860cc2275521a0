#pragma once
// This machine's memory.

#include <unistd.h>

namespace binosplat {

/// All of it, in bytes.
inline double memory_bytes() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// From now on a crash ends the program with ExitCode::out_of_memory and a line that says so, if no more
/// memory is to be had by then: drivers of OpenGL do not look whether they got what they asked for. Other
/// crashes end it as they did. For `main`: a handler is the whole process's.
void end_cleanly_without_memory();

}  // namespace binosplat
