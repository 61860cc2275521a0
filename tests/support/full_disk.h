#pragma once
// Simulates a full disk while an object lives: no file of this process may grow beyond a size.

#include <sys/resource.h>

#include <csignal>

namespace binosplat::test {

class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    // Ignore the signal, as the program does; otherwise it would end this process.
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

}  // namespace binosplat::test
