#pragma once
// The ways to a context without a window, for Context::open. Each opens and makes current, or throws
// Error(no_gl) that says what is missing.

#include <dlfcn.h>

#include <memory>

#include "base/error.h"
#include "gl/context.h"

namespace binosplat::gl {

/// Throws Error for a library that dlopen() has just not opened, with what it said: (out_of_memory) where
/// there was no room for it, else (no_gl) with `what_to_install`.
[[noreturn]] void fail_to_load(const char* library, const char* what_to_install);

/// The function `name` of a library that dlopen() has opened, or Error(no_gl) with `what_to_install`.
template <typename F>
void load_function(void* opened, const char* library, const char* name, const char* what_to_install,
                   F& function) {
  function = reinterpret_cast<F>(dlsym(opened, name));
  if (function == nullptr)
    throw Error(ExitCode::no_gl, fmt::format("{} has no {}. {}", library, name, what_to_install));
}

/// Through EGL's device platform; `device` as in Context::open. Throws Error(bad_input) for a number that
/// there is not.
std::unique_ptr<Context> open_egl_device(int device);

/// Through EGL's surfaceless platform, which Mesa has.
std::unique_ptr<Context> open_egl_surfaceless();

/// Mesa's renderer as a library of its own, libOSMesa: no EGL, no driver.
std::unique_ptr<Context> open_osmesa();

}  // namespace binosplat::gl
