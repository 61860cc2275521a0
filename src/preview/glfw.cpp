#include "preview/glfw.h"

#include <string>

#include "base/error.h"

namespace binosplat::preview {

namespace {

std::string glfw_said;

constexpr const char* instead = "`binosplat render` draws without a display";

}  // namespace

Glfw::Glfw() {
  glfwSetErrorCallback([](int, const char* text) { glfw_said = text; });
  if (glfwInit() == GLFW_FALSE)
    throw Error(ExitCode::no_gl, fmt::format("no display for a window ({}): {}", glfw_said, instead));
}

Glfw::~Glfw() { glfwTerminate(); }

GLFWwindow* open_window(const glm::ivec2& size, bool stereo) {
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_SRGB_CAPABLE, GLFW_FALSE);
  glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);
  glfwWindowHint(GLFW_STEREO, stereo ? GLFW_TRUE : GLFW_FALSE);
  GLFWwindow* window = glfwCreateWindow(size.x, size.y, "binosplat", nullptr, nullptr);
  if (window == nullptr && stereo) {
    throw Error(ExitCode::no_gl,
                fmt::format("--layout quad-buffer: this driver has no stereo windows ({}): choose another "
                            "--layout",
                            glfw_said));
  }
  if (window == nullptr) {
    throw Error(ExitCode::no_gl, fmt::format("this display has no OpenGL 4.5 ({}): {}", glfw_said, instead));
  }
  return window;
}

}  // namespace binosplat::preview
