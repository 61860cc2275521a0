#pragma once
// The ways to open a context without a window, for Context::open. Each opens a context and makes it current,
// or throws Error(no_gl) that names what is missing.

#include <dlfcn.h>

#include <memory>

#include "base/error.h"
#include "gl/context.h"

namespace binosplat::gl {

/// Throws Error for a library that dlopen() has just failed to open, with dlopen()'s message: (out_of_memory)
/// if it did not fit, else (no_gl) with `what_to_install`.
[[noreturn]] void fail_to_load(const char* library, const char* what_to_install);

/// Loads the function `name` of an open library. Throws Error(no_gl) with `what_to_install` if it is missing.
template <typename F>
void load_function(void* opened, const char* library, const char* name, const char* what_to_install,
                   F& function) {
  function = reinterpret_cast<F>(dlsym(opened, name));
  if (function == nullptr)
    throw Error(ExitCode::no_gl, fmt::format("{} has no {}. {}", library, name, what_to_install));
}

/// Through EGL's device platform; `device` as in Context::open. Throws Error(bad_input) for an unknown
/// number.
std::unique_ptr<Context> open_egl_device(int device);

/// Through EGL's surfaceless platform, which Mesa has.
std::unique_ptr<Context> open_egl_surfaceless();

/// Through libOSMesa, Mesa's renderer as a library: needs no EGL and no driver.
std::unique_ptr<Context> open_osmesa();

}  // namespace binosplat::gl
