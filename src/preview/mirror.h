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

  /// False once the window is closed, or Escape was pressed in it.
  bool is_open();

  /// Shows the first view of a frame as large as the window has room for: from the lower left corner of this
  /// texture, of so many px, where the frame went onto canvases.
  void show(const render::Frame& frame, std::uint32_t texture, const glm::ivec2& size,
            const glm::vec3& background);

 private:
  Glfw glfw_;
  GLFWwindow* window_ = nullptr;
  std::unique_ptr<gl::Context> context_;
  std::unique_ptr<stereo::Presenter> presenter_;
  std::unique_ptr<gl::Texture> picture_;
  std::uint32_t framebuffer_ = 0;  // of what is shown
};

}  // namespace binosplat::preview
