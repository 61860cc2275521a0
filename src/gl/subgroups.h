#pragma once
// Whether a context's subgroups are as the shaders that use subgroups expect.

#include <string>

#include "gl/context.h"

namespace binosplat::gl {

/// Why shaders must do without subgroups here, as in "its subgroups have 64 invocations"; empty where they
/// may use them: GL_KHR_shader_subgroup is there with all that they need, in groups of 32, and small
/// dispatches in the shapes of those shaders find the lanes where they should be; the program cache keeps
/// what they found. Leaves the context's state as it is.
std::string why_no_subgroups(Context& context);

/// Runs those dispatches, whatever the driver and the cache say; what they found wrong, or empty.
std::string found_in_subgroups(Context& context);

}  // namespace binosplat::gl
