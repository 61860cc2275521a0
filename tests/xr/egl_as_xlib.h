#pragma once
// How the EGL binding gets past Khronos' validation (xr/egl_layer.cpp).

#include <EGL/egl.h>

#include <cstdint>
#include <cstring>
#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_PLATFORM_EGL
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

namespace binosplat::xr_test {

/// What the loader says of itself, as its specification has it; no package has its header.
struct LoaderInfo {
  std::uint32_t type, version;
  std::size_t size;
  std::uint32_t min_interface, max_interface;
  XrVersion min_api, max_api;
};

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
