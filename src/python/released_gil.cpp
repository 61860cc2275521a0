#include "python/released_gil.h"

#include <pthread.h>
#include <unistd.h>

#include <atomic>
#include <csignal>

namespace binosplat::python {

namespace {

std::atomic<int> alive = 0;
std::atomic<bool> python_is_gone = false, is_interrupted = false;

void leave() {
  --alive;
  alive.notify_all();
}

[[noreturn]] void sleep_to_the_end() {
  leave();
  while (true) pause();
}

void wait_for_all() {
  python_is_gone = true;
  if (is_interrupted && alive > 0) {
    std::signal(SIGINT, SIG_DFL);
    std::raise(SIGINT);
  }
  for (int left = alive; left > 0; left = alive) alive.wait(left);
}

}  // namespace

// Counts first: Python, which the next line lets go on, may end at once.
ReleasedGil::ReleasedGil() {
  ++alive;
  state_ = PyEval_SaveThread();
}

ReleasedGil::~ReleasedGil() {
  // After Python has ended, PyEval_RestoreThread() would let the thread continue.
  if (python_is_gone) sleep_to_the_end();
  try {
    PyEval_RestoreThread(state_);
  } catch (...) {  // Python calls pthread_exit() during its shutdown
    sleep_to_the_end();
  }
  leave();
}

void ReleasedGil::outlive_all() {
  Py_AtExit(wait_for_all);
  namespace py = pybind11;
  // Python stores the exception that ended it in sys.last_type.
  py::module_::import("atexit").attr("register")(py::cpp_function([] {
    const py::object last = py::getattr(py::module_::import("sys"), "last_type", py::none());
    is_interrupted = last.is(py::handle(PyExc_KeyboardInterrupt));
  }));
  // A forked process lacks the other threads.
  pthread_atfork(nullptr, nullptr, [] { alive = 0; });
}

bool ReleasedGil::ends_by_interrupt() { return is_interrupted; }

ProcessKeepAlive::ProcessKeepAlive() { ++alive; }
ProcessKeepAlive::~ProcessKeepAlive() { leave(); }

}  // namespace binosplat::python
