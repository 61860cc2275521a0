#include "xr/api.h"

#include <dlfcn.h>
#include <openxr/openxr_reflection.h>

#include <cstdlib>

#include "base/error.h"

namespace binosplat::xr {

namespace {

template <typename Function>
void load(XrInstance instance, const char* name, Function& function) {
  function = find<Function>(instance, name);
  if (function == nullptr)
    throw Error(ExitCode::no_gl, fmt::format("this OpenXR runtime has no {}: update it", name));
}

}  // namespace

const Loader& loader() {
  static const Loader loaded = [] {
    setenv("XR_LOADER_DEBUG", "none", 0);  // what it would say is said here, in one line
    void* library = dlopen("libopenxr_loader.so.1", RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) {
      throw Error(
          ExitCode::no_gl,
          fmt::format("no OpenXR loader ({}). On Debian: apt install libopenxr-loader1, and a runtime "
                      "for the headset, such as SteamVR or Monado",
                      dlerror()));
    }
    Loader found;
    found.GetInstanceProcAddr =
        reinterpret_cast<PFN_xrGetInstanceProcAddr>(dlsym(library, "xrGetInstanceProcAddr"));
    if (found.GetInstanceProcAddr == nullptr)
      throw Error(ExitCode::no_gl,
                  "libopenxr_loader.so.1 has no xrGetInstanceProcAddr: it is no OpenXR loader");
    const auto of_loader = [&](const char* name, auto& function) {
      PFN_xrVoidFunction pointer = nullptr;
      found.GetInstanceProcAddr(XR_NULL_HANDLE, name, &pointer);
      function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(pointer);
      if (function == nullptr)
        throw Error(ExitCode::no_gl, fmt::format("libopenxr_loader.so.1 has no {}", name));
    };
    of_loader("xrEnumerateInstanceExtensionProperties", found.EnumerateInstanceExtensionProperties);
    of_loader("xrCreateInstance", found.CreateInstance);
    return found;
  }();
  return loaded;
}

Api load_api(XrInstance instance) {
  Api api;
#define BINOSPLAT_XR_LOAD(name) load(instance, "xr" #name, api.name);
  BINOSPLAT_XR_FUNCTIONS(BINOSPLAT_XR_LOAD)
#undef BINOSPLAT_XR_LOAD
  return api;
}

std::string name_of(XrResult result) {
  switch (result) {
#define BINOSPLAT_XR_NAME(name, value) \
  case name:                           \
    return #name;
    XR_LIST_ENUM_XrResult(BINOSPLAT_XR_NAME)
#undef BINOSPLAT_XR_NAME
        default : return fmt::format("error {}", static_cast<int>(result));
  }
}

void check(XrResult result, const char* call) {
  if (XR_SUCCEEDED(result)) return;
  if (result == XR_ERROR_SESSION_LOST) throw Lost{};
  if (result == XR_ERROR_INSTANCE_LOST) throw Lost{.instance = true};
  throw Error(ExitCode::no_gl, fmt::format("OpenXR: {} failed: {}", call, name_of(result)));
}

}  // namespace binosplat::xr
