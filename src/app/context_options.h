#pragma once
// The options that choose the OpenGL context.

#include <memory>
#include <string>

#include "app/cli.h"
#include "gl/context.h"

namespace binosplat::app {

struct ContextOptions {
  gl::Backend backend = gl::Backend::automatic;
  int device = -1;         // number of the EGL device; -1: the first GPU
  std::string shader_dir;  // empty: the embedded shaders
};

/// Adds all of them; `options` must outlive parsing.
void add_context_options(CLI::App& sub, ContextOptions& options);

/// --device, for commands that take few.
CLI::Option* add_device_option(CLI::App& sub, ContextOptions& options);

/// Throws Error for a device number with a backend without devices. `with_devices` lists the others.
void check(const ContextOptions& options, const char* with_devices = "device or auto");

/// Opens the requested context and logs which it is.
std::unique_ptr<gl::Context> open_context(const ContextOptions& options);

/// The same for a command that keeps no intermediate results. Logs that, on a CPU or if `on_gpus`, because
/// the command may then take long.
std::unique_ptr<gl::Context> open_context_for_all(const std::string& command, bool on_gpus,
                                                  const ContextOptions& options);

}  // namespace binosplat::app
