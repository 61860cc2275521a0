#pragma once
// A context of GLX for xr/client.cpp, without the headers of X, whose macros collide with half of everything.

#include <dlfcn.h>

#include <stdexcept>

#include "xr/egl_as_xlib.h"

namespace binosplat::xr_test {

template <typename T>
T* x_function(void* library, const char* name) {
  void* found = library == nullptr ? nullptr : dlsym(library, name);
  if (found == nullptr) throw std::runtime_error(std::string("no ") + name);
  return reinterpret_cast<T*>(found);
}

/// A context of OpenGL 4.5 core, current, with a drawable that nobody sees.
inline XlibBinding make_glx_context() {
  void* x = dlopen("libX11.so.6", RTLD_NOW);
  void* glx = dlopen("libGL.so.1", RTLD_NOW);
  XlibBinding out = {XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR};
  out.display = x_function<void*(const char*)>(x, "XOpenDisplay")(nullptr);
  if (out.display == nullptr) throw std::runtime_error("no display");
  const int wanted[] = {0x8010 /* GLX_DRAWABLE_TYPE */, 4 /* pbuffer */, 0x8011 /* GLX_RENDER_TYPE */, 1, 0};
  int count = 0;
  auto** configs = x_function<void**(void*, int, const int*, int*)>(glx, "glXChooseFBConfig")(out.display, 0,
                                                                                              wanted, &count);
  if (configs == nullptr || count == 0) throw std::runtime_error("no configuration of GLX");
  out.config = configs[0];
  const int size[] = {0x8041 /* GLX_PBUFFER_WIDTH */, 16, 0x8040 /* GLX_PBUFFER_HEIGHT */, 16, 0};
  out.drawable = x_function<unsigned long(void*, void*, const int*)>(glx, "glXCreatePbuffer")(
      out.display, out.config, size);
  const int version[] = {0x2091 /* major */, 4, 0x2092 /* minor */, 5, 0x9126 /* profile: core */, 1, 0};
  const auto get = x_function<void (*(const unsigned char*))()>(glx, "glXGetProcAddressARB");
  using Create = void* (*)(void*, void*, void*, int, const int*);
  const auto create =
      reinterpret_cast<Create>(get(reinterpret_cast<const unsigned char*>("glXCreateContextAttribsARB")));
  out.context = create(out.display, out.config, nullptr, 1, version);
  if (x_function<int(void*, unsigned long, void*)>(glx, "glXMakeCurrent")(out.display, out.drawable,
                                                                          out.context) == 0) {
    throw std::runtime_error("no context of GLX");
  }
  return out;
}

}  // namespace binosplat::xr_test
