#pragma once
// A disk that is full for as long as an object lives: no file of this process may grow beyond a size.

#include <sys/resource.h>

#include <csignal>

namespace binosplat::test {

class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    // Like the program, which would otherwise be ended by the signal.
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
