#pragma once
// OpenXR's functions and runtime. The first call opens the loader. No program links to the loader, so all
// other features work without it.

#define XR_NO_PROTOTYPES
#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_PLATFORM_EGL
#define XR_USE_PLATFORM_XLIB
#define EGL_NO_X11  // the macros of X11's headers collide with our names
#include <EGL/egl.h>
// The types of Xlib and GLX that openxr_platform.h needs.
using Display = struct _XDisplay;
using GLXContext = struct __GLXcontextRec*;
using GLXFBConfig = struct __GLXFBConfigRec*;
using GLXDrawable = unsigned long;
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

/// A function of the loader. Throws Error(no_gl) without a loader.
PFN_xrVoidFunction find(const char* name);

/// Calls OpenXR's xrNAME and returns its unchecked result.
#define XR_CALL(name, ...) reinterpret_cast<PFN_xr##name>(find("xr" #name))(__VA_ARGS__)
/// The same, with check().
#define XR(name, ...) check(XR_CALL(name, __VA_ARGS__), "xr" #name)

/// The name of a result, as in "XR_ERROR_RUNTIME_FAILURE".
std::string name_of(XrResult result);

/// Thrown if the runtime lost the session, or the whole instance.
struct Lost {
  bool instance = false;
};

/// Returns `result`, unless it is a failure. Throws Lost if the session or the instance is lost. Throws
/// Error(no_gl) for other failures; its text names the call and the result.
XrResult check(XrResult result, const char* call);

/// Throws Error(no_gl) for a fault of the runtime or the headset.
template <typename... Args>
[[noreturn]] void refuse(fmt::format_string<Args...> format, Args&&... args) {
  throw Error(ExitCode::no_gl, fmt::format(format, std::forward<Args>(args)...));
}

/// Reads a list of OpenXR: `enumerate` first returns the count, then fills the elements.
template <typename T, typename Enumerate>
std::vector<T> all_of(const T& empty, const Enumerate& enumerate) {
  std::uint32_t count = 0;
  enumerate(0u, &count, static_cast<T*>(nullptr));
  std::vector<T> all(count, empty);
  if (count > 0) enumerate(count, &count, all.data());
  all.resize(count, empty);
  return all;
}

struct Destroy {
  const char* call = nullptr;

  template <typename T>
  void operator()(T* handle) const {
    reinterpret_cast<XrResult(XRAPI_PTR*)(T*)>(find(call))(handle);
  }
};
template <typename Handle>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Destroy>;

/// Creates an object with xrCREATE: XR_OWNED(Space, CreateReferenceSpace, session, &info) is an
/// Owned<XrSpace>.
#define XR_OWNED(Kind, create, ...)                    \
  [&] {                                                \
    Xr##Kind made = XR_NULL_HANDLE;                    \
    XR(create, __VA_ARGS__, &made);                    \
    return Owned<Xr##Kind>(made, {"xrDestroy" #Kind}); \
  }()

/// A runtime and its headset.
struct Instance {
  /// Connects to the runtime and finds the headset. Throws Error(no_gl), with a text of one line, if there is
  /// no loader, runtime or headset, or if the runtime does not support OpenGL, or `passthrough`: to show the
  /// room around the model.
  explicit Instance(bool passthrough = false);

  bool has(std::string_view extension) const { return std::ranges::count(extensions, extension) > 0; }
  /// Whether the runtime takes OpenGL contexts of EGL, as Monado does. Others, such as SteamVR, take contexts
  /// of GLX only, which need an X display.
  bool takes_egl() const { return has("XR_MNDX_egl_enable"); }
  /// Whether there are four views instead of two: both wide views, then both insets.
  bool has_insets() const { return views != XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO; }
  XrResult find_headset();  // updates `system`; succeeds if a headset is connected
  XrPath path(const std::string& text) const;
  /// A function of an enabled extension.
  template <typename Function>
  Function function(const char* name) const {
    PFN_xrVoidFunction found = nullptr;
    XR(GetInstanceProcAddr, handle.get(), name, &found);
    return reinterpret_cast<Function>(found);
  }

  std::vector<const char*> extensions;  // the enabled extensions
  Owned<XrInstance> handle;
  XrSystemId system = XR_NULL_SYSTEM_ID;
  std::string runtime, headset;  // "Monado 21.0.0"; the headset's name
  XrViewConfigurationType views = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
  XrEnvironmentBlendMode blend_mode = XR_ENVIRONMENT_BLEND_MODE_OPAQUE;  // another one shows the room

 private:
  void connect();
  void show_room();
};

}  // namespace binosplat::xr
