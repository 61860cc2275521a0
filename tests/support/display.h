#pragma once
// An X display without a screen.

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <string>

namespace binosplat::test {

/// Runs Xvfb while this object lives. name() is empty if Xvfb is not installed or does not start.
class VirtualDisplay {
 public:
  VirtualDisplay() {
    int ends[2];
    if (pipe(ends) != 0) return;
    server_ = fork();
    if (server_ == 0) {
      dup2(ends[1], 3);
      execlp("Xvfb", "Xvfb", "-displayfd", "3", "-screen", "0", "800x600x24", "-nolisten", "tcp", "-noreset",
             nullptr);
      _exit(127);
    }
    close(ends[1]);
    // Read to the end of the line: if the pipe closes earlier, Xvfb quits.
    std::string number;
    for (char c = 0; c != '\n' && read(ends[0], &c, 1) == 1;) number += c;
    if (!number.empty()) name_ = ":" + std::to_string(std::atoi(number.c_str()));
    close(ends[0]);
  }
  ~VirtualDisplay() {
    if (server_ <= 0) return;
    kill(server_, SIGTERM);
    waitpid(server_, nullptr, 0);
  }
  VirtualDisplay(const VirtualDisplay&) = delete;
  VirtualDisplay& operator=(const VirtualDisplay&) = delete;

  const std::string& name() const { return name_; }

 private:
  pid_t server_ = -1;
  std::string name_;
};

}  // namespace binosplat::test
