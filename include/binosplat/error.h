#pragma once
// Errors, and what the library says on standard error.

#include <stdexcept>
#include <string>

namespace binosplat {

/// The kind of an Error. The numbers are the exit codes of the program `binosplat`.
enum class ExitCode {
  done = 0,
  fell_short = 1,     // the program's: a comparison did not reach what was asked for
  bad_input = 2,      // a file or an argument that cannot be used
  no_gl = 3,          // the context lacks what binosplat needs, or its GPU was reset
  out_of_memory = 4,  // on the GPU or on this machine
};

/// The library's exception if the caller, a file or the machine is at fault. what() is written for people: it
/// names the file or the argument, what was expected, and what to do. Besides it the library lets
/// std::bad_alloc pass, and throws std::runtime_error where OpenGL reports an error that is the library's
/// own. The object whose call threw can be used again, unless its GPU was reset, and destroyed in any case.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& text) : std::runtime_error(text), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

/// The library writes lines that begin with "binosplat: " to standard error: warnings, and, unless it is
/// quiet, what else is worth knowing, such as Gaussians of a file that it left out. It is not quiet at first.
/// Holds for the whole program; may be called from any thread.
void set_quiet(bool quiet);

}  // namespace binosplat
