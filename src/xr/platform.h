#pragma once
// What OpenXR says of OpenGL, with EGL and with Xlib: its header for them needs the platforms' own before it,
// and all who include it must define the same.

#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_PLATFORM_EGL
#define XR_USE_PLATFORM_XLIB

#include "xr/openxr.h"

#include <EGL/egl.h>
#include <GL/glcorearb.h>
#include <GL/glx.h>
#include <X11/Xlib.h>

#include <openxr/openxr_platform.h>
