#pragma once
// OpenXR's entry points. The loader is opened when it is asked for: without it all else works, and nothing
// links to it.

#ifndef XR_NO_PROTOTYPES
#define XR_NO_PROTOTYPES
#endif
#include <openxr/openxr.h>

#include <string>

namespace binosplat::xr {

// X(name without xr): those that every runtime has.
#define BINOSPLAT_XR_FUNCTIONS(X)      \
  X(DestroyInstance)                   \
  X(GetInstanceProperties)             \
  X(PollEvent)                         \
  X(GetSystem)                         \
  X(GetSystemProperties)               \
  X(EnumerateViewConfigurations)       \
  X(EnumerateViewConfigurationViews)   \
  X(EnumerateEnvironmentBlendModes)    \
  X(CreateSession)                     \
  X(DestroySession)                    \
  X(BeginSession)                      \
  X(EndSession)                        \
  X(RequestExitSession)                \
  X(EnumerateReferenceSpaces)          \
  X(CreateReferenceSpace)              \
  X(CreateActionSpace)                 \
  X(LocateSpace)                       \
  X(DestroySpace)                      \
  X(EnumerateSwapchainFormats)         \
  X(CreateSwapchain)                   \
  X(DestroySwapchain)                  \
  X(EnumerateSwapchainImages)          \
  X(AcquireSwapchainImage)             \
  X(WaitSwapchainImage)                \
  X(ReleaseSwapchainImage)             \
  X(WaitFrame)                         \
  X(BeginFrame)                        \
  X(EndFrame)                          \
  X(LocateViews)                       \
  X(StringToPath)                      \
  X(CreateActionSet)                   \
  X(DestroyActionSet)                  \
  X(CreateAction)                      \
  X(DestroyAction)                     \
  X(SuggestInteractionProfileBindings) \
  X(AttachSessionActionSets)           \
  X(SyncActions)                       \
  X(GetActionStateBoolean)             \
  X(GetActionStateVector2f)            \
  X(GetActionStatePose)

/// An instance's functions; those of extensions are asked for by name (find).
struct Api {
#define BINOSPLAT_XR_MEMBER(name) PFN_xr##name name = nullptr;
  BINOSPLAT_XR_FUNCTIONS(BINOSPLAT_XR_MEMBER)
#undef BINOSPLAT_XR_MEMBER
};

/// The loader's own functions, before there is an instance. Throws Error(no_gl) without a loader.
struct Loader {
  PFN_xrGetInstanceProcAddr GetInstanceProcAddr = nullptr;
  PFN_xrEnumerateInstanceExtensionProperties EnumerateInstanceExtensionProperties = nullptr;
  PFN_xrCreateInstance CreateInstance = nullptr;
};
const Loader& loader();

Api load_api(XrInstance instance);

/// A function of an extension that the instance has; null if it has not.
template <typename Function>
Function find(XrInstance instance, const char* name) {
  PFN_xrVoidFunction function = nullptr;
  loader().GetInstanceProcAddr(instance, name, &function);
  return reinterpret_cast<Function>(function);
}

/// "XR_ERROR_RUNTIME_FAILURE"
std::string name_of(XrResult result);

/// Checks the result of `call`: throws Error(no_gl) that names both for a failure, and Lost where the runtime
/// is gone.
void check(XrResult result, const char* call);

/// The session or the whole instance is lost, and all that belongs to it.
struct Lost {
  bool instance = false;
};

}  // namespace binosplat::xr
