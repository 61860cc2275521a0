#pragma once
// GLFW, and a window of it with the context that drawing needs.

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <glm/glm.hpp>

namespace binosplat::preview {

/// GLFW from its start to its end. Throws Error(no_gl) where there is no display.
struct Glfw {
  Glfw();
  ~Glfw();
  Glfw(const Glfw&) = delete;
  Glfw& operator=(const Glfw&) = delete;
};

/// A window of a size in px with OpenGL 4.5, or a stereo one. Throws Error(no_gl) where there is none.
GLFWwindow* open_window(const glm::ivec2& size, bool stereo);

}  // namespace binosplat::preview
