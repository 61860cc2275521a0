#pragma once
// GLFW, and a window of it with the context that drawing needs.

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <glm/glm.hpp>
#include <optional>

namespace binosplat::preview {

/// GLFW from its start to its end. Throws Error(no_gl) where there is no display.
struct Glfw {
  Glfw();
  ~Glfw();
  Glfw(const Glfw&) = delete;
  Glfw& operator=(const Glfw&) = delete;
};

/// A window with OpenGL 4.5, or a stereo one, of a size in px; without one, of what suits the display's
/// scale. Throws Error(no_gl) where there is none.
GLFWwindow* open_window(const std::optional<glm::ivec2>& size, bool stereo);

/// A window that fills the screen it stands on, and where it goes back to.
class FullScreen {
 public:
  void enter(GLFWwindow* window);
  /// False if it does not fill the screen.
  bool leave(GLFWwindow* window);

 private:
  glm::ivec2 place_{0}, size_{0};  // of the window before
};

}  // namespace binosplat::preview
