#pragma once
// A window beside a headset: the context that draws, and what the left eye sees.

#include <glm/glm.hpp>
#include <memory>

#include "gl/context.h"
#include "preview/glfw.h"

namespace binosplat::preview {

class Mirror {
 public:
  /// Opens the window and makes its context current. `by_egl`: a context of EGL, which OpenXR's runtimes may
  /// take where they take none of the window system's own. Throws Error(no_gl) as open_window() does.
  explicit Mirror(bool by_egl);
  ~Mirror();
  Mirror(const Mirror&) = delete;
  Mirror& operator=(const Mirror&) = delete;

  gl::Context& context() { return *context_; }

  /// False once the window is closed, or Escape was pressed in it.
  bool is_open();

  /// Shows what lies in the lower left corner of a texture, so many px, as large as the window has room for.
  void show(std::uint32_t texture, const glm::ivec2& size);

 private:
  Glfw glfw_;
  GLFWwindow* window_ = nullptr;
  std::unique_ptr<gl::Context> context_;
  std::uint32_t framebuffer_ = 0;  // of what is shown
};

}  // namespace binosplat::preview
