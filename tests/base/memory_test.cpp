#include "base/memory.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdlib>

namespace binosplat {
namespace {

/// Limits the address space to 64 MiB, so that hardly any memory can be allocated.
void take_all_memory() {
  const rlimit limit = {rlim_t{64} << 20, rlim_t{64} << 20};
  setrlimit(RLIMIT_AS, &limit);
}

TEST(MemoryDeathTest, CrashReportsOutOfMemory) {
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  const auto crash = [](bool without_memory, int signal) {
    end_cleanly_without_memory();
    if (without_memory) take_all_memory();
    signal == SIGABRT ? std::abort() : static_cast<void>(raise(signal));
    raise(signal);  // a fault is raised again when its handler returns
  };
  for (const int signal : {SIGABRT, SIGSEGV}) {
    EXPECT_EXIT(crash(true, signal), testing::ExitedWithCode(4),
                "binosplat: out of memory: a library crashed");
    // Injected: there is memory, so the crash has another reason.
#ifdef __SANITIZE_ADDRESS__  // ends the program itself at a SIGSEGV
    if (signal == SIGSEGV) {
      EXPECT_EXIT(crash(false, signal), testing::ExitedWithCode(1), "AddressSanitizer: SEGV");
      continue;
    }
#endif
    EXPECT_EXIT(crash(false, signal), testing::KilledBySignal(signal), "");
  }
}

}  // namespace
}  // namespace binosplat
