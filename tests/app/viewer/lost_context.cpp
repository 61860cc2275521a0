// Loaded before libglfw (LD_PRELOAD): OpenGL then reports a reset of the GPU once the file named by
// LOST_CONTEXT exists.

#include <dlfcn.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

namespace {

using Function = void (*)();

unsigned reset_status() {
  constexpr unsigned unknown_context_reset = 0x8255;
  return access(std::getenv("LOST_CONTEXT"), F_OK) == 0 ? unknown_context_reset : 0;
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming): GLFW's own name
extern "C" Function glfwGetProcAddress(const char* name) {
  if (std::strcmp(name, "glGetGraphicsResetStatus") == 0) return reinterpret_cast<Function>(reset_status);
  using Get = Function (*)(const char*);
  static const Get next = reinterpret_cast<Get>(dlsym(RTLD_NEXT, "glfwGetProcAddress"));
  return next(name);
}
