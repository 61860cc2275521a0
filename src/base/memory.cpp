#include "base/memory.h"

#include <sys/mman.h>

#include <csignal>
#include <cstddef>

#include "base/error.h"

namespace binosplat {

namespace {

struct sigaction before_abort, before_fault;

/// Whether the system refuses an allocation of a size that drivers request.
bool is_out_of_memory() {
  constexpr std::size_t probe_bytes = std::size_t{256} << 20;
  void* const taken = mmap(nullptr, probe_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (taken == MAP_FAILED) return true;
  munmap(taken, probe_bytes);
  return false;
}

/// Calls only async-signal-safe functions (signal-safety(7)), and mmap and munmap, which are system calls.
void on_crash(int signal) {
  if (is_out_of_memory()) {
    constexpr char text[] =
        "\nbinosplat: out of memory: a library crashed when memory ran out; raise the limit (ulimit -v), or "
        "draw smaller pictures or fewer Gaussians\n";
    static_cast<void>(!write(STDERR_FILENO, text, sizeof(text) - 1));
    _exit(static_cast<int>(ExitCode::out_of_memory));
  }
  // Restores the previous handler. Then the fault repeats, or abort() continues.
  sigaction(signal, signal == SIGABRT ? &before_abort : &before_fault, nullptr);
}

}  // namespace

void end_cleanly_without_memory() {
  struct sigaction action = {};
  action.sa_handler = on_crash;
  sigaction(SIGABRT, &action, &before_abort);
  sigaction(SIGSEGV, &action, &before_fault);
}

}  // namespace binosplat
