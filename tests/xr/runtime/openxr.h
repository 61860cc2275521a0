#pragma once
// OpenXR as the runtime, its client and the tests use it.

#include <EGL/egl.h>
#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_PLATFORM_EGL
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

// Newer than Debian's headers.
constexpr XrReferenceSpaceType XR_REFERENCE_SPACE_TYPE_LOCAL_FLOOR_TEST =
    static_cast<XrReferenceSpaceType>(1000426000);
constexpr const char* XR_LOCAL_FLOOR_NAME = "XR_EXT_local_floor";
