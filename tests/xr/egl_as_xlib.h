#pragma once
// How the EGL binding gets past Khronos' validation (xr/egl_layer.cpp).

#include <cstdint>
#include <cstring>

#include "xr/runtime/openxr.h"

namespace binosplat::xr_test {

// XrGraphicsBindingOpenGLXlibKHR, without the headers of X, whose macros collide with half of everything.
struct XlibBinding {
  XrStructureType type;
  const void* next;
  void* display;
  std::uint32_t visual;
  void* config;
  unsigned long drawable;
  void* context;
};

constexpr std::uint32_t egl_visual = 0xE61;  // the drawable is the address of an EGL binding

inline XlibBinding as_xlib(const XrGraphicsBindingEGLMNDX& egl) {
  return {XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR, egl.next,   egl.display, egl_visual, egl.config,
          reinterpret_cast<unsigned long>(&egl),    egl.context};
}

}  // namespace binosplat::xr_test
