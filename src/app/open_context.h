#pragma once
// Opens the OpenGL context that options choose.

#include <memory>

#include "app/options/options.h"
#include "gl/context.h"

namespace binosplat::app {

/// Opens the requested context and logs which it is. Throws Error for a device number if
/// the backend has no devices.
std::unique_ptr<gl::Context> open_context(const ContextOptions& options);

}  // namespace binosplat::app
