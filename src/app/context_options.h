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

/// Adds all options of ContextOptions; `options` must outlive parsing.
void add_context_options(CLI::App& sub, ContextOptions& options);
CLI::Option* add_device_option(CLI::App& sub, ContextOptions& options);

/// Throws Error for a device number if the backend has no devices.
void check(const ContextOptions& options);

/// Opens the requested context and logs which it is. Throws as check() does.
std::unique_ptr<gl::Context> open_context(const ContextOptions& options);

/// The same for a command that stores no intermediate results. If the context is on a CPU, or if `on_gpus`,
/// logs that the command may take long and cannot be resumed.
std::unique_ptr<gl::Context> open_context_for_all(const std::string& command, bool on_gpus,
                                                  const ContextOptions& options);

}  // namespace binosplat::app
