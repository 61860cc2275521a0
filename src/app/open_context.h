#pragma once
// Opens the OpenGL context that options choose.

#include <memory>
#include <string>

#include "app/options/options.h"
#include "gl/context.h"

namespace binosplat::app {

/// Opens the requested context and logs which it is. Throws Error for a device number if
/// the backend has no devices.
std::unique_ptr<gl::Context> open_context(const ContextOptions& options);

/// The same for a command that stores no intermediate results. If the context is on a CPU, or if `on_gpus`,
/// logs that the command may take long and cannot be resumed.
std::unique_ptr<gl::Context> open_context_for_all(const std::string& command, bool on_gpus,
                                                  const ContextOptions& options);

}  // namespace binosplat::app
