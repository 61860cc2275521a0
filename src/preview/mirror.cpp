#include "preview/mirror.h"

#include <algorithm>

#include "base/log.h"

namespace binosplat::preview {

Mirror::Mirror(bool by_egl) {
  if (by_egl) glfwWindowHint(GLFW_CONTEXT_CREATION_API, GLFW_EGL_CONTEXT_API);
  window_ = open_window(glm::ivec2(960, 960), false);
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(0);  // the headset keeps the time
  context_ = gl::Context::adopt(glfwGetProcAddress);
  presenter_ = std::make_unique<stereo::Presenter>(*context_);
  log_info("drawing with {} (OpenGL {})", context_->renderer(), context_->version());
}

Mirror::~Mirror() {
  context_->gl().DeleteFramebuffers(1, &framebuffer_);
  picture_.reset();
  presenter_.reset();
  context_.reset();
  glfwDestroyWindow(window_);
}

bool Mirror::step(const render::Frame* drawn, const glm::vec3& background) {
  glfwPollEvents();
  if (drawn != nullptr) {
    show(*drawn, background);
    glfwSwapBuffers(window_);
  }
  return glfwWindowShouldClose(window_) == GLFW_FALSE && glfwGetKey(window_, GLFW_KEY_ESCAPE) != GLFW_PRESS;
}

void Mirror::show(const render::Frame& frame, const glm::vec3& background) {
  const gl::Functions& gl = context_->gl();
  const shared::View& eye = frame.views()[0];
  const auto width = static_cast<int>(eye.width), height = static_cast<int>(eye.height);
  if (picture_ == nullptr || !picture_->is(GL_RGBA8, width, height)) {
    picture_.reset();  // its memory first
    picture_ = std::make_unique<gl::Texture>(*context_, GL_RGBA8, width, height);
    if (framebuffer_ == 0) gl.CreateFramebuffers(1, &framebuffer_);
    gl.NamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, picture_->id(), 0);
  }
  presenter_->draw(frame, 0, LAYOUT_SEPARATE, {.texture = picture_->id()}, background);
  glm::ivec2 window;
  glfwGetFramebufferSize(window_, &window.x, &window.y);
  const double scale = std::min(double(window.x) / width, double(window.y) / height);
  const glm::ivec2 size(scale * width, scale * height), corner = (window - size) / 2;
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  gl.ClearColor(0.0f, 0.0f, 0.0f, 1.0f);
  gl.Clear(GL_COLOR_BUFFER_BIT);
  gl.BlitNamedFramebuffer(framebuffer_, 0, 0, 0, width, height, corner.x, corner.y, corner.x + size.x,
                          corner.y + size.y, GL_COLOR_BUFFER_BIT, GL_LINEAR);
}

}  // namespace binosplat::preview
