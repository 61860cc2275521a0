#include "preview/mirror.h"

#include <algorithm>

#include "base/log.h"

namespace binosplat::preview {

Mirror::Mirror(bool is_egl, bool is_hidden) : glfw_(!is_egl) {
  glfwWindowHint(GLFW_CONTEXT_CREATION_API, is_egl ? GLFW_EGL_CONTEXT_API : GLFW_NATIVE_CONTEXT_API);
  glfwWindowHint(GLFW_VISIBLE, is_hidden ? GLFW_FALSE : GLFW_TRUE);
  window_ = open_window(glm::ivec2(960, 960), false);
  glfwMakeContextCurrent(window_);
  glfwSetInputMode(window_, GLFW_STICKY_KEYS, GLFW_TRUE);  // catches taps shorter than a frame
  glfwSwapInterval(0);                                     // the headset sets the frame rate
  context_ = gl::Context::adopt(glfwGetProcAddress);
  log_info("drawing with {} (OpenGL {})", context_->renderer(), context_->version());
}

Mirror::~Mirror() {
  context_->gl().DeleteFramebuffers(1, &framebuffer_);
  context_.reset();
  glfwDestroyWindow(window_);
}

bool Mirror::step() {
  if (drawn_) glfwSwapBuffers(window_);
  drawn_ = false;
  glfwPollEvents();
  return glfwWindowShouldClose(window_) == GLFW_FALSE && glfwGetKey(window_, GLFW_KEY_ESCAPE) != GLFW_PRESS;
}

bool Mirror::take_record_key() {
  const bool was_down = is_record_down_;
  is_record_down_ = glfwGetKey(window_, GLFW_KEY_F8) == GLFW_PRESS;
  return is_record_down_ && !was_down;
}

void Mirror::show(const Target& picture, const glm::ivec2& size) {
  const gl::Functions& gl = context_->gl();
  if (framebuffer_ == 0) gl.CreateFramebuffers(1, &framebuffer_);
  gl.NamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, picture.texture, 0);
  glm::ivec2 window;
  glfwGetFramebufferSize(window_, &window.x, &window.y);
  const double scale = std::min(double(window.x) / size.x, double(window.y) / size.y);
  const glm::ivec2 shown(scale * size.x, scale * size.y), corner = (window - shown) / 2;
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  gl.ClearColor(0.0f, 0.0f, 0.0f, 1.0f);
  gl.Clear(GL_COLOR_BUFFER_BIT);
  gl.BlitNamedFramebuffer(framebuffer_, 0, 0, 0, size.x, size.y, corner.x, corner.y, corner.x + shown.x,
                          corner.y + shown.y, GL_COLOR_BUFFER_BIT, GL_LINEAR);
  gl.NamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, 0, 0);  // the runtime owns the texture
  drawn_ = true;
}

}  // namespace binosplat::preview
