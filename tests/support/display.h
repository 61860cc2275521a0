#pragma once
// An X display without a screen (Xvfb), for programs that open windows.

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace binosplat::test {

class VirtualDisplay {
 public:
  static bool is_there() { return std::system("command -v Xvfb > /dev/null") == 0; }

  VirtualDisplay() {
    int ends[2];
    if (pipe(ends) != 0) throw std::runtime_error("no pipe");
    server_ = fork();
    if (server_ == 0) {
      dup2(ends[1], 3);
      execlp("Xvfb", "Xvfb", "-displayfd", "3", "-screen", "0", "800x600x24", "-nolisten", "tcp", nullptr);
      _exit(127);
    }
    close(ends[1]);
    char number[16] = {};
    const bool started = read(ends[0], number, sizeof(number) - 1) > 0;
    close(ends[0]);
    if (!started) throw std::runtime_error("Xvfb did not start");
    name_ = ":" + std::to_string(std::atoi(number));
  }
  ~VirtualDisplay() {
    kill(server_, SIGTERM);
    waitpid(server_, nullptr, 0);
  }
  VirtualDisplay(const VirtualDisplay&) = delete;
  VirtualDisplay& operator=(const VirtualDisplay&) = delete;

  /// For the variable DISPLAY.
  const std::string& name() const { return name_; }

 private:
  pid_t server_ = -1;
  std::string name_;
};

}  // namespace binosplat::test
