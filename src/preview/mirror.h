#pragma once
// A window beside a headset: the context that draws, and what the left eye sees.

#include <memory>

#include "gl/texture.h"
#include "preview/glfw.h"
#include "render/frame.h"
#include "stereo/present.h"

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

  /// Shows the first view of a frame, if there is one, as large as the window has room for. False once the
  /// window is closed, or Escape was pressed in it.
  bool step(const render::Frame* drawn, const glm::vec3& background);

 private:
  void show(const render::Frame& frame, const glm::vec3& background);

  Glfw glfw_;
  GLFWwindow* window_ = nullptr;
  std::unique_ptr<gl::Context> context_;
  std::unique_ptr<stereo::Presenter> presenter_;
  std::unique_ptr<gl::Texture> picture_;
  std::uint32_t framebuffer_ = 0;  // of it
};

}  // namespace binosplat::preview
