#pragma once
// Work of ours beside Python's.

#include <pybind11/pybind11.h>

namespace binosplat::python {

/// While one lives, Python's other threads may run; the thread that made it calls nothing of Python's, and
/// uses no more than it holds itself: Python frees what daemon threads were given when it ends. In the place
/// of py::gil_scoped_release: where Python has ended meanwhile, as it does beside daemon threads, the thread
/// sleeps until the process has, too. Python would end it by an exception that no destructor lets pass.
class Unlocked {
 public:
  Unlocked();
  ~Unlocked();
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

  /// Once, when the module is made: from then on the process waits for what such threads do before it ends.
  /// Drivers and libraries that have cleaned up crash those that still use them.
  static void outlive_all();

 private:
  PyThreadState* state_;
};

}  // namespace binosplat::python
