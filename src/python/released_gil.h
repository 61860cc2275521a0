#pragma once
// Work without Python's lock.

#include <pybind11/pybind11.h>

#include <chrono>
#include <future>
#include <utility>

namespace binosplat::python {

/// Releases Python's lock while it exists, as py::gil_scoped_release. The thread must not call Python, and
/// must own all that it uses: Python's shutdown frees objects of daemon threads. If Python has ended
/// meanwhile, the thread sleeps until the process ends. Otherwise Python would end it by an exception that no
/// destructor can pass.
class ReleasedGil {
 public:
  ReleasedGil();
  ~ReleasedGil();
  ReleasedGil(const ReleasedGil&) = delete;
  ReleasedGil& operator=(const ReleasedGil&) = delete;

  /// Call it once, when the module is created: from then on the process waits for such threads before it
  /// ends. Otherwise drivers and libraries that have shut down crash threads that still use them.
  static void outlive_all();

  /// Whether Python ends because of an uncaught KeyboardInterrupt. The process then does not wait: it ends by
  /// the signal, and skips the exit handlers of drivers.
  static bool ends_by_interrupt();

 private:
  PyThreadState* state_;
};

/// Work without Python. While one exists, the process does not end, as with ReleasedGil.
class ProcessKeepAlive {
 public:
  ProcessKeepAlive();
  ~ProcessKeepAlive();
  ProcessKeepAlive(const ProcessKeepAlive&) = delete;
  ProcessKeepAlive& operator=(const ProcessKeepAlive&) = delete;
};

/// Waits for a result without Python's lock. On Python's main thread, Ctrl-C ends the wait by
/// KeyboardInterrupt. The work continues, and its result is dropped.
template <typename Result>
Result awaited(std::future<Result> result) {
  constexpr std::chrono::milliseconds between_looks(50);
  while (true) {
    {
      const ReleasedGil released;
      if (result.wait_for(between_looks) == std::future_status::ready) break;
    }
    if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
  }
  return result.get();
}

}  // namespace binosplat::python
