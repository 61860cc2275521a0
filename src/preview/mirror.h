#pragma once
// A window beside a headset: the context that draws, and what the left eye sees.

#include <glm/glm.hpp>
#include <memory>

#include "gl/context.h"
#include "preview/glfw.h"
#include "stereo/present.h"

namespace binosplat::preview {

class Mirror {
 public:
  /// Opens the window and makes its context current: one of EGL, which OpenXR's runtimes take. Throws
  /// Error(no_gl) as open_window() does.
  Mirror();
  ~Mirror();
  Mirror(const Mirror&) = delete;
  Mirror& operator=(const Mirror&) = delete;

  gl::Context& context() { return *context_; }

  /// Takes the `size` px in the lower left corner of a texture, scaled to what the window has room for.
  void show(const Target& picture, const glm::ivec2& size);

  /// Brings it onto the screen, and takes the window's events: false once it is closed, or Escape was pressed
  /// in it.
  bool step();

  /// Whether F8, which records, was pressed since the last call.
  bool take_record_key();

 private:
  Glfw glfw_;
  GLFWwindow* window_ = nullptr;
  std::unique_ptr<gl::Context> context_;
  std::uint32_t framebuffer_ = 0;  // of what is shown
  bool drawn_ = false;             // and not on the screen yet
  bool is_record_down_ = false;    // when it was asked last
};

}  // namespace binosplat::preview
