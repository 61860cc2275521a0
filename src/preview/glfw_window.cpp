#include "preview/glfw_window.h"

#include <string>

#include "base/error.h"
#include "gl/context.h"
#include "gl/driver_watch.h"

namespace binosplat::preview {

namespace {

std::string glfw_said;

constexpr const char* instead = ": use `binosplat render`, which needs no display";

}  // namespace

Glfw::Glfw(bool needs_x11) {
#ifdef GLFW_PLATFORM  // GLFW before 3.4 has one platform only
  if (needs_x11) glfwInitHint(GLFW_PLATFORM, GLFW_PLATFORM_X11);
#endif
  glfwSetErrorCallback([](int, const char* text) { glfw_said = text; });
  gl::ignore_overrides();
  if (glfwInit() == GLFW_FALSE)
    throw Error(ExitCode::no_gl,
                fmt::format("no display for a window ({}){}", glfw_said, needs_x11 ? "" : instead));
}

Glfw::~Glfw() { glfwTerminate(); }

GLFWwindow* open_window(const std::optional<glm::ivec2>& size, bool stereo) {
  const glm::ivec2 wanted = size.value_or(glm::ivec2(1280, 720));
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, size ? GLFW_FALSE : GLFW_TRUE);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);
  glfwWindowHint(GLFW_STEREO, stereo ? GLFW_TRUE : GLFW_FALSE);
  const std::jthread watch = gl::watch_driver();
  GLFWwindow* window = glfwCreateWindow(wanted.x, wanted.y, "binosplat", nullptr, nullptr);
  if (window == nullptr && stereo) {
    throw Error(ExitCode::no_gl,
                fmt::format("`layout` quad-buffer: this driver has no stereo windows ({}): choose another",
                            glfw_said));
  }
  if (window == nullptr) {
    throw Error(ExitCode::no_gl, fmt::format("this display has no OpenGL 4.5 ({}){}", glfw_said, instead));
  }
  return window;
}

namespace {

// The screen with the window's middle, or the primary one.
GLFWmonitor* screen_of(const glm::ivec2& place, const glm::ivec2& size) {
  int count = 0;
  GLFWmonitor** const screens = glfwGetMonitors(&count);
  for (int k = 0; k < count; ++k) {
    glm::ivec2 corner;
    glfwGetMonitorPos(screens[k], &corner.x, &corner.y);
    const GLFWvidmode* const mode = glfwGetVideoMode(screens[k]);
    const glm::ivec2 at = place + size / 2 - corner;
    if (mode != nullptr && at.x >= 0 && at.y >= 0 && at.x < mode->width && at.y < mode->height)
      return screens[k];
  }
  return glfwGetPrimaryMonitor();
}

}  // namespace

void FullScreen::enter(GLFWwindow* window) {
  glfwGetWindowPos(window, &place_.x, &place_.y);
  glfwGetWindowSize(window, &size_.x, &size_.y);
  GLFWmonitor* const screen = screen_of(place_, size_);
  const GLFWvidmode* const mode = screen != nullptr ? glfwGetVideoMode(screen) : nullptr;
  if (mode == nullptr) return;
  glfwSetWindowMonitor(window, screen, 0, 0, mode->width, mode->height, mode->refreshRate);
}

bool FullScreen::leave(GLFWwindow* window) {
  if (glfwGetWindowMonitor(window) == nullptr) return false;
  glfwSetWindowMonitor(window, nullptr, place_.x, place_.y, size_.x, size_.y, GLFW_DONT_CARE);
  return true;
}

}  // namespace binosplat::preview
