#pragma once
// OpenXR as the runtime, its client and the tests use it.

#include <EGL/egl.h>
#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_PLATFORM_EGL
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>
