#pragma once
// Errors, and the library's messages on standard error.

#include <stdexcept>
#include <string>

namespace binosplat {

/// The kind of an Error. The numbers are the exit codes of the program `binosplat`.
enum class ExitCode {
  done = 0,
  fell_short = 1,     // returned by the program only: a comparison missed the required value
  bad_input = 2,      // an unusable file or argument
  no_gl = 3,          // the context lacks a feature that binosplat needs, or its GPU was reset
  out_of_memory = 4,  // on the GPU or on this machine
};

/// The library throws an Error if the caller, a file or the machine is at fault. what() is written for
/// people: it names the file or the argument, the expected value, and the remedy. The library also passes
/// std::bad_alloc on, and throws std::runtime_error for its own OpenGL errors. An object whose function has
/// thrown remains usable, unless its GPU was reset. It can always be destroyed.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& text) : std::runtime_error(text), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

/// If `quiet`, the library writes only warnings to standard error. By default it also writes other messages,
/// such as counts of removed Gaussians. Each message begins with "binosplat: ". The choice applies to the
/// whole program; any thread may call this function.
void set_quiet(bool quiet);

}  // namespace binosplat
