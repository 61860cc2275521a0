#pragma once
// How OpenXR is told of the OpenGL context that draws.

#include <memory>

namespace binosplat::xr {

class Instance;

constexpr const char* opengl_extension = "XR_KHR_opengl_enable";
constexpr const char* egl_extension = "XR_MNDX_egl_enable";

/// Describes the context that is current, for XrSessionCreateInfo::next. An EGL context needs a runtime with
/// XR_MNDX_egl_enable, one of GLX needs none. Throws Error(no_gl) for a runtime that does not take the
/// context, or whose range of OpenGL versions 4.5 lies out of.
std::shared_ptr<const void> binding_of_current_context(const Instance& instance);

}  // namespace binosplat::xr
