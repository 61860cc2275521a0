#pragma once
// Where frames are drawn.

#include <memory>
#include <string>

#include "app/cli.h"
#include "gl/context.h"

namespace binosplat::app {

struct ContextOptions {
  gl::Backend backend = gl::Backend::automatic;
  int device = -1;         // of EGL's; -1: the first GPU
  std::string shader_dir;  // empty: the embedded shaders
};

/// Adds all of them; `options` must outlive the parsing.
void add_context_options(CLI::App& sub, ContextOptions& options);

/// --device, for commands that take few.
CLI::Option* add_device_option(CLI::App& sub, ContextOptions& options);

/// Throws Error for a device of a backend that has none; it says which ones do.
void check(const ContextOptions& options, const char* with_devices = "device or auto");

/// The context that they name; the log says what it is.
std::unique_ptr<gl::Context> open_context(const ContextOptions& options);

/// The same for a command that keeps nothing of its work until all of it is done. The log says so, too, where
/// that takes long: on a CPU, or with `on_gpus` anywhere.
std::unique_ptr<gl::Context> open_context_for_all(const std::string& command, bool on_gpus,
                                                  const ContextOptions& options);

}  // namespace binosplat::app
