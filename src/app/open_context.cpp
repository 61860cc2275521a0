#include "app/open_context.h"

#include "app/options/checks.h"
#include "base/log.h"
#include "gl/driver_watch.h"

namespace binosplat::app {

std::unique_ptr<gl::Context> open_context(const ContextOptions& o) {
  check(o);
  const std::jthread watch = gl::watch_driver();
  auto context = gl::Context::open(o.backend, o.device);
  log_info("drawing with {} ({}, OpenGL {})", context->renderer(), context->backend(), context->version());
  if (!o.shader_dir.empty()) context->set_shader_folder(o.shader_dir);
  return context;
}

}  // namespace binosplat::app
