#pragma once
// Tests whether a context's subgroups behave as shaders with subgroups expect.

#include <string>

#include "gl/context.h"

namespace binosplat::gl {

/// Returns why shaders must not use subgroups here, as in "its subgroups have 64 invocations"; empty if they
/// may. They may if GL_KHR_shader_subgroup has all required features in groups of 32, and small dispatches in
/// those shaders' group shapes find all lanes in place. The program cache stores the result. Does not change
/// the context's state.
std::string why_no_subgroups(Context& context);

/// Runs those dispatches, whatever the driver and the cache report. Returns the fault found, or an empty
/// text.
std::string run_subgroup_tests(Context& context);

}  // namespace binosplat::gl
