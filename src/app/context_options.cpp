#include "app/context_options.h"

#include "app/option_checks.h"
#include "base/error.h"
#include "base/log.h"
#include "gl/driver_watch.h"

namespace binosplat::app {

using gl::Backend;

void add_context_options(CLI::App& sub, ContextOptions& o) {
  sub.option_defaults()->group("Drawing");
  choose<Backend>(sub, "--backend", o.backend,
                  "Source of OpenGL: a GPU by EGL's devices, Mesa without a GPU, Mesa\nwithout EGL, or the "
                  "first that works (auto)",
                  {{"auto", Backend::automatic},
                   {"device", Backend::device},
                   {"surfaceless", Backend::surfaceless},
                   {"osmesa", Backend::osmesa}});
  add_device_option(sub, o);
  sub.add_option("--shader-dir", o.shader_dir, "Read shaders from this folder, not the built-in ones")
      ->type_name("DIR")
      ->check(folder());
}

CLI::Option* add_device_option(CLI::App& sub, ContextOptions& o) {
  return add_value(sub, "--device", "N", o.device, range(0, 1000),
                   "Number of the EGL device, as `binosplat devices` lists it");
}

void check(const ContextOptions& o) {
  if (o.device >= 0 && (o.backend == Backend::surfaceless || o.backend == Backend::osmesa))
    fail("--device is for GPUs: {} has none", o.backend == Backend::osmesa ? "osmesa" : "surfaceless");
}

std::unique_ptr<gl::Context> open_context(const ContextOptions& o) {
  check(o);
  const std::jthread watch = gl::watch_driver();
  auto context = gl::Context::open(o.backend, o.device);
  log_info("drawing with {} ({}, OpenGL {})", context->renderer(), context->backend(), context->version());
  if (!o.shader_dir.empty()) context->set_shader_folder(o.shader_dir);
  return context;
}

std::unique_ptr<gl::Context> open_context_for_all(const std::string& command, bool on_gpus,
                                                  const ContextOptions& options) {
  auto context = open_context(options);
  if (on_gpus || context->software())
    log_info("{} may take long and stores no partial results: an interrupted run must start over", command);
  return context;
}

}  // namespace binosplat::app
