#pragma once
// How the EGL binding gets past Khronos' validation: as an Xlib binding (xr/egl_layer.cpp).

#include <EGL/egl.h>

#include <cstdint>
#include <cstring>
#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_PLATFORM_EGL
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

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

}  // namespace binosplat::xr_test
