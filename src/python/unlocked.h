#pragma once
// Work of ours beside Python's.

#include <pybind11/pybind11.h>

#include <chrono>
#include <future>
#include <utility>

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

  /// Whether Python ends because nobody caught the KeyboardInterrupt of a Ctrl-C. Then what is under way is
  /// not waited for: the process ends by the signal, and calls nothing that drivers have registered.
  static bool ends_by_interrupt();

 private:
  PyThreadState* state_;
};

/// Work that goes on without Python: while one lives, the process does not end, as with Unlocked.
class Outlived {
 public:
  Outlived();
  ~Outlived();
  Outlived(const Outlived&) = delete;
  Outlived& operator=(const Outlived&) = delete;
};

/// Waits for a result while Python's other threads run. On Python's main thread a Ctrl-C ends the wait by
/// KeyboardInterrupt; the work goes on, and its result is dropped.
template <typename Result>
Result awaited(std::future<Result> result) {
  constexpr std::chrono::milliseconds between_looks(50);
  while (true) {
    {
      const Unlocked unlocked;
      if (result.wait_for(between_looks) == std::future_status::ready) break;
    }
    if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
  }
  return result.get();
}

}  // namespace binosplat::python
