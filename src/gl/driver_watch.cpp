#include "gl/driver_watch.h"

#include <unistd.h>

#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <string>

#include "base/error.h"
#include "base/log.h"

namespace binosplat::gl {

namespace {

std::string set_variables() {
  std::string text;
  for (const char* name :
       {"GALLIUM_DRIVER", "LIBGL_ALWAYS_SOFTWARE", "MESA_LOADER_DRIVER_OVERRIDE",
        "__EGL_VENDOR_LIBRARY_FILENAMES", "VK_DRIVER_FILES", "VK_ICD_FILENAMES", "EGL_PLATFORM"}) {
    if (const char* const value = std::getenv(name); value != nullptr)
      text += fmt::format("{}{}={}", text.empty() ? "" : ", ", name, value);
  }
  return text;
}

void end_after(const std::stop_token& stop, std::chrono::milliseconds patience) {
  std::mutex mutex;
  std::unique_lock lock(mutex);
  std::condition_variable_any stopped;
  stopped.wait_for(lock, stop, patience, [] { return false; });
  if (stop.stop_requested()) return;
  const std::string variables = set_variables();
  const std::string advice = variables.empty() ? "try another `backend`" : "unset " + variables;
  log_line(fmt::format("the driver has made no OpenGL context in {:.3g} s: {}",
                       std::chrono::duration<double>(patience).count(), advice));
  _exit(static_cast<int>(ExitCode::no_gl));
}

}  // namespace

std::jthread watch_driver(std::chrono::milliseconds patience) { return std::jthread(end_after, patience); }

}  // namespace binosplat::gl
