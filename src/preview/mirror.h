#pragma once
// A window beside a headset: it owns the OpenGL context and shows the left eye.

#include <binosplat/targets.h>
#include <glm/glm.hpp>
#include <memory>

#include "gl/context.h"
#include "preview/glfw_window.h"

namespace binosplat::preview {

class Mirror {
 public:
  /// Opens the window with a context of EGL or of GLX, as the OpenXR runtime takes it, and makes the context
  /// current. A hidden window only owns the context. Throws as open_window() does.
  Mirror(bool is_egl, bool is_hidden);
  ~Mirror();
  Mirror(const Mirror&) = delete;
  Mirror& operator=(const Mirror&) = delete;

  gl::Context& context() { return *context_; }

  /// Draws the lower left `size` px of a texture, scaled to fit the window.
  void show(const Target& picture, const glm::ivec2& size);

  /// Swaps buffers and handles the window's events. Returns false if the window was closed or Escape pressed.
  bool step();

  /// Whether F8 (record) was pressed since the last call.
  bool take_record_key();

 private:
  Glfw glfw_;
  GLFWwindow* window_ = nullptr;
  std::unique_ptr<gl::Context> context_;
  std::uint32_t framebuffer_ = 0;  // for the texture to show
  bool drawn_ = false;             // the texture is drawn, but the buffers are not swapped yet
  bool is_record_down_ = false;    // F8 was pressed at the last call
};

}  // namespace binosplat::preview
