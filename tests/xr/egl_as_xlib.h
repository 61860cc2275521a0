#pragma once
// Converts the EGL binding to an Xlib binding, which Khronos' validation accepts (xr/egl_layer.cpp).

#include <EGL/egl.h>

#include <cstdint>
#include <cstring>
#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_PLATFORM_EGL
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

namespace binosplat::xr_test {

// XrGraphicsBindingOpenGLXlibKHR without the headers of X, whose macros collide with many names.
struct XlibBinding {
  XrStructureType type;
  const void* next;
  void* display;
  std::uint32_t visual;
  void* config;
  unsigned long drawable;
  void* context;
};

}  // namespace binosplat::xr_test
