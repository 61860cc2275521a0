#include "python/unlocked.h"

#include <pthread.h>
#include <unistd.h>

#include <atomic>

namespace binosplat::python {

namespace {

std::atomic<int> alive = 0;

void wait_for_all() {
  for (int left = alive; left > 0; left = alive) alive.wait(left);
}

}  // namespace

Unlocked::Unlocked() : state_(PyEval_SaveThread()) { ++alive; }

Unlocked::~Unlocked() {
  --alive;
  alive.notify_all();
  try {
    PyEval_RestoreThread(state_);
  } catch (...) {  // pthread_exit(), which Python calls once it has ended
    while (true) pause();
  }
}

void Unlocked::outlive_all() {
  Py_AtExit(wait_for_all);
  // The threads of the others are not in a process that is forked.
  pthread_atfork(nullptr, nullptr, [] { alive = 0; });
}

}  // namespace binosplat::python
