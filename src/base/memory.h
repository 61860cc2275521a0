#pragma once
// This machine's memory.

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>

namespace binosplat {

/// The machine's physical memory in bytes, or less if the process may not address as much (ulimit -v).
inline double memory_bytes() {
  rlimit limit{};
  getrlimit(RLIMIT_AS, &limit);  // a huge number if there is no limit
  const double page = static_cast<double>(sysconf(_SC_PAGESIZE));
  return std::min(page * static_cast<double>(sysconf(_SC_PHYS_PAGES)), static_cast<double>(limit.rlim_cur));
}

/// Installs handlers for crashes; only `main` may call it. OpenGL drivers do not check their allocations. If
/// memory is exhausted, the handlers report this and end the process with ExitCode::out_of_memory.
void end_cleanly_without_memory();

}  // namespace binosplat
