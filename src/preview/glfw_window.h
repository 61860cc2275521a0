#pragma once
// GLFW, and its windows with an OpenGL context.

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <glm/glm.hpp>
#include <optional>

namespace binosplat::preview {

/// Initialises and terminates GLFW. `needs_x11`: the native contexts must be GLX's, also on a Wayland
/// desktop. Throws Error(no_gl) without a display.
struct Glfw {
  explicit Glfw(bool needs_x11 = false);
  ~Glfw();
  Glfw(const Glfw&) = delete;
  Glfw& operator=(const Glfw&) = delete;
};

/// Opens a window with OpenGL 4.5, if `stereo` with a left and a right buffer. `size`: px; none: suits the
/// display's scale. Throws Error(no_gl) if the display has no such window.
GLFWwindow* open_window(const std::optional<glm::ivec2>& size, bool stereo);

/// Toggles full screen, and remembers the window's place and size.
class FullScreen {
 public:
  void enter(GLFWwindow* window);
  /// Returns false if the window is not in full screen.
  bool leave(GLFWwindow* window);

 private:
  glm::ivec2 place_{0}, size_{0};  // the window's before full screen
};

}  // namespace binosplat::preview
