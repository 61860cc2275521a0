#pragma once
// The functions with which Context::open opens a context without a window. Each makes its context current, or
// throws Error(no_gl) that names what is missing.

#include <dlfcn.h>

#include <memory>

#include "base/error.h"
#include "gl/context.h"

namespace binosplat::gl {

/// Call it right after dlopen() has failed to open `library`. Throws Error with dlopen()'s message:
/// (out_of_memory) if memory was too small, else (no_gl) with `what_to_install`.
[[noreturn]] void fail_to_load(const char* library, const char* what_to_install);

/// Loads function `name` of the opened library, or throws Error(no_gl) with `what_to_install`.
template <typename F>
void load_function(void* opened, const char* library, const char* name, const char* what_to_install,
                   F& function) {
  function = reinterpret_cast<F>(dlsym(opened, name));
  if (function == nullptr)
    throw Error(ExitCode::no_gl, fmt::format("{} has no {}. {}", library, name, what_to_install));
}

/// Uses EGL's device platform; `device` as in Context::open. Throws Error(bad_input) without that device.
std::unique_ptr<Context> open_egl_device(int device);

/// Uses EGL's surfaceless platform, which Mesa has.
std::unique_ptr<Context> open_egl_surfaceless();

/// Uses libOSMesa, Mesa's renderer as a library, which needs no EGL and no driver.
std::unique_ptr<Context> open_osmesa();

}  // namespace binosplat::gl
