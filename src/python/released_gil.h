#pragma once
// Lets threads work without Python's lock.

#include <pybind11/pybind11.h>

#include <chrono>
#include <future>

namespace binosplat::python {

/// Releases Python's lock while the object exists, as py::gil_scoped_release does. Meanwhile the thread must
/// not call Python, and must own all that it uses, because Python's shutdown frees the objects of daemon
/// threads. If Python ends meanwhile, the destructor puts the thread to sleep until the process ends.
/// Otherwise Python would end the thread by an exception, which must not leave a destructor.
class ReleasedGil {
 public:
  ReleasedGil();
  ~ReleasedGil();
  ReleasedGil(const ReleasedGil&) = delete;
  ReleasedGil& operator=(const ReleasedGil&) = delete;

  /// Call it once, when the module is created. The process then ends only after all threads without Python's
  /// lock, which would otherwise crash in drivers and libraries that have shut down.
  static void outlive_all();

  /// Whether Python ends because of an uncaught KeyboardInterrupt. The process then does not wait for
  /// threads: it ends by the signal, and skips the exit handlers of drivers.
  static bool ends_by_interrupt();

 private:
  PyThreadState* state_ = nullptr;
};

/// For threads that never call Python. While one exists, the process does not end, as with ReleasedGil.
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
