#pragma once
// OpenXR's graphics bindings of EGL and Xlib, without the headers of X, whose macros collide with many names.

#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_PLATFORM_EGL
#define XR_USE_PLATFORM_XLIB
#define EGL_NO_X11
#include <EGL/egl.h>
using Display = struct _XDisplay;
using GLXContext = struct __GLXcontextRec*;
using GLXFBConfig = struct __GLXFBConfigRec*;
using GLXDrawable = unsigned long;
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>
