#pragma once
// Tests whether a context's subgroups behave as shaders with subgroups expect.

#include <string>

#include "gl/context.h"

namespace binosplat::gl {

/// Returns why shaders must not use subgroups in this context, such as "its subgroups have 64 invocations".
/// Empty if GL_KHR_shader_subgroup has all required features in subgroups of 32, and run_subgroup_tests()
/// finds no fault; the program cache stores its result. Does not change the context's state.
std::string why_no_subgroups(Context& context);

/// Tests the subgroups, in the work group shapes of all shaders with subgroups. Ignores the driver's claims
/// and the cache. Returns the worst fault, or an empty text.
std::string run_subgroup_tests(Context& context);

}  // namespace binosplat::gl
