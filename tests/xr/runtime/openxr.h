#pragma once
// OpenXR as the runtime, its client and the tests use it.

#include <EGL/egl.h>
#include <cstdint>
#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_PLATFORM_EGL
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

// Newer than Debian's headers.
constexpr XrReferenceSpaceType XR_REFERENCE_SPACE_TYPE_LOCAL_FLOOR_TEST =
    static_cast<XrReferenceSpaceType>(1000426000);
constexpr const char* XR_LOCAL_FLOOR_NAME = "XR_EXT_local_floor";

namespace binosplat::xr_test {

/// What the loader says of itself, as its specification has it; no package has its header.
struct LoaderInfo {
  std::uint32_t type, version;
  std::size_t size;
  std::uint32_t min_interface, max_interface;
  XrVersion min_api, max_api;
};

}  // namespace binosplat::xr_test
