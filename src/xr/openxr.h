#pragma once
// OpenXR's functions, and the runtime that has them. The loader is opened when one is called: nothing links
// to it, and without it all else works.

#define XR_NO_PROTOTYPES
#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_PLATFORM_EGL
#define EGL_NO_X11  // whose macros have names of ours
#include <EGL/egl.h>
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/error.h"

namespace binosplat::xr {

/// A function of the loader's. Throws Error(no_gl) without a loader.
PFN_xrVoidFunction find(const char* name);

/// OpenXR's xrNAME: its result, unchecked.
#define XR_CALL(name, ...) reinterpret_cast<PFN_xr##name>(find("xr" #name))(__VA_ARGS__)
/// The same, checked.
#define XR(name, ...) check(XR_CALL(name, __VA_ARGS__), "xr" #name)

/// "XR_ERROR_RUNTIME_FAILURE"
std::string name_of(XrResult result);

/// The session or the whole instance is lost, and all that belongs to it.
struct Lost {
  bool instance = false;
};

/// Returns the result of `call`. Throws Error(no_gl) that names both for a failure, and Lost where the
/// runtime is gone.
XrResult check(XrResult result, const char* call);

/// Throws Error(no_gl): the runtime or the headset is at fault.
template <typename... Args>
[[noreturn]] void refuse(fmt::format_string<Args...> format, Args&&... args) {
  throw Error(ExitCode::no_gl, fmt::format(format, std::forward<Args>(args)...));
}

/// A list of OpenXR's, which `enumerate` tells by its count first, and then by its elements.
template <typename T, typename Enumerate>
std::vector<T> all_of(const T& empty, const Enumerate& enumerate) {
  std::uint32_t count = 0;
  enumerate(0u, &count, static_cast<T*>(nullptr));
  std::vector<T> all(count, empty);
  if (count > 0) enumerate(count, &count, all.data());
  all.resize(count, empty);
  return all;
}

/// An object of OpenXR's, which ends with it.
struct Destroy {
  const char* call = nullptr;

  template <typename T>
  void operator()(T* handle) const {
    reinterpret_cast<XrResult(XRAPI_PTR*)(T*)>(find(call))(handle);
  }
};
template <typename Handle>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Destroy>;

/// What xrCREATE makes: XR_OWNED(Space, CreateReferenceSpace, session, &info) is an Owned<XrSpace>.
#define XR_OWNED(Kind, create, ...)                    \
  [&] {                                                \
    Xr##Kind made = XR_NULL_HANDLE;                    \
    XR(create, __VA_ARGS__, &made);                    \
    return Owned<Xr##Kind>(made, {"xrDestroy" #Kind}); \
  }()

/// A runtime and its headset.
struct Instance {
  /// Connects to the runtime and finds the headset. Throws Error(no_gl), in one line, for no loader, no
  /// runtime, a runtime that takes no OpenGL or no EGL, and no headset.
  Instance();

  bool has(std::string_view extension) const { return std::ranges::count(extensions, extension) > 0; }
  /// Whether there are four views, both eyes' wide ones and then both insets, in place of two.
  bool has_insets() const { return views != XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO; }
  XrResult find_headset();  // whether one is there now
  XrPath path(const std::string& text) const;
  /// A function of an extension that it has.
  template <typename Function>
  Function function(const char* name) const {
    PFN_xrVoidFunction found = nullptr;
    XR(GetInstanceProcAddr, handle.get(), name, &found);
    return reinterpret_cast<Function>(found);
  }

  std::vector<const char*> extensions;  // that are enabled
  Owned<XrInstance> handle;
  XrSystemId system = XR_NULL_SYSTEM_ID;
  std::string runtime, headset;  // "Monado 21.0.0", and the headset's name
  XrViewConfigurationType views = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;

 private:
  void connect();
};

}  // namespace binosplat::xr
