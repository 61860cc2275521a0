// What the loader finds: how the runtime is negotiated with, and the table of its functions.

#include <cstdio>
#include <cstring>

#include "xr/runtime/api.h"

namespace binosplat::xr_test {
namespace {

// As the loader's specification has them; no package has its header.
struct LoaderInfo {
  std::uint32_t type, version;
  std::size_t size;
  std::uint32_t min_interface, max_interface;
  XrVersion min_api, max_api;
};
struct RuntimeRequest {
  std::uint32_t type, version;
  std::size_t size;
  std::uint32_t interface_version;
  XrVersion api_version;
  PFN_xrGetInstanceProcAddr get;
};
constexpr std::uint32_t type_loader_info = 1, type_runtime_request = 3, interface_version = 1;

template <std::size_t N>
struct Name {
  constexpr Name(const char (&from)[N]) {  // NOLINT(google-explicit-constructor): a literal names a function
    for (std::size_t k = 0; k < N; ++k) text[k] = from[k];
  }
  char text[N]{};
};

template <Name name, typename... Arguments>
PFN_xrVoidFunction entry_of(XrResult (*)(Arguments...));

/// A function as the loader calls it.
template <Name name, auto function>
struct Entry;
template <Name name, typename... Arguments, XrResult (*function)(Arguments...)>
struct Entry<name, function> {
  static XrResult XRAPI_CALL call(Arguments... arguments) {
    return guarded(name.text, [&] { return function(arguments...); });
  }
};

struct Row {
  const char* name;
  PFN_xrVoidFunction function;
  const char* extension;  // without which it is not there
};

#define BINOSPLAT_ENTRY_OF(name, extension) \
  { "xr" #name, reinterpret_cast<PFN_xrVoidFunction>(&Entry<Name("xr" #name), &api::name>::call), extension }
#define BINOSPLAT_ENTRY(name) BINOSPLAT_ENTRY_OF(name, nullptr)

const Row table[] = {
    BINOSPLAT_ENTRY(EnumerateInstanceExtensionProperties),
    BINOSPLAT_ENTRY(CreateInstance),
    BINOSPLAT_ENTRY(DestroyInstance),
    BINOSPLAT_ENTRY(GetInstanceProperties),
    BINOSPLAT_ENTRY(PollEvent),
    BINOSPLAT_ENTRY(ResultToString),
    BINOSPLAT_ENTRY(StructureTypeToString),
    BINOSPLAT_ENTRY(StringToPath),
    BINOSPLAT_ENTRY(PathToString),
    BINOSPLAT_ENTRY(GetSystem),
    BINOSPLAT_ENTRY(GetSystemProperties),
    BINOSPLAT_ENTRY(EnumerateEnvironmentBlendModes),
    BINOSPLAT_ENTRY(EnumerateViewConfigurations),
    BINOSPLAT_ENTRY(GetViewConfigurationProperties),
    BINOSPLAT_ENTRY(EnumerateViewConfigurationViews),
    BINOSPLAT_ENTRY(GetOpenGLGraphicsRequirementsKHR),
    BINOSPLAT_ENTRY(CreateSession),
    BINOSPLAT_ENTRY(DestroySession),
    BINOSPLAT_ENTRY(BeginSession),
    BINOSPLAT_ENTRY(EndSession),
    BINOSPLAT_ENTRY(RequestExitSession),
    BINOSPLAT_ENTRY(EnumerateReferenceSpaces),
    BINOSPLAT_ENTRY(CreateReferenceSpace),
    BINOSPLAT_ENTRY(GetReferenceSpaceBoundsRect),
    BINOSPLAT_ENTRY(LocateSpace),
    BINOSPLAT_ENTRY(DestroySpace),
    BINOSPLAT_ENTRY(LocateViews),
    BINOSPLAT_ENTRY(EnumerateSwapchainFormats),
    BINOSPLAT_ENTRY(CreateSwapchain),
    BINOSPLAT_ENTRY(DestroySwapchain),
    BINOSPLAT_ENTRY(EnumerateSwapchainImages),
    BINOSPLAT_ENTRY(AcquireSwapchainImage),
    BINOSPLAT_ENTRY(WaitSwapchainImage),
    BINOSPLAT_ENTRY(ReleaseSwapchainImage),
    BINOSPLAT_ENTRY(WaitFrame),
    BINOSPLAT_ENTRY(BeginFrame),
    BINOSPLAT_ENTRY(EndFrame),
    BINOSPLAT_ENTRY(CreateActionSpace),
    BINOSPLAT_ENTRY(CreateActionSet),
    BINOSPLAT_ENTRY(DestroyActionSet),
    BINOSPLAT_ENTRY(CreateAction),
    BINOSPLAT_ENTRY(DestroyAction),
    BINOSPLAT_ENTRY(SuggestInteractionProfileBindings),
    BINOSPLAT_ENTRY(AttachSessionActionSets),
    BINOSPLAT_ENTRY(GetCurrentInteractionProfile),
    BINOSPLAT_ENTRY(GetActionStateBoolean),
    BINOSPLAT_ENTRY(GetActionStateFloat),
    BINOSPLAT_ENTRY(GetActionStateVector2f),
    BINOSPLAT_ENTRY(GetActionStatePose),
    BINOSPLAT_ENTRY(SyncActions),
    BINOSPLAT_ENTRY(EnumerateBoundSourcesForAction),
    BINOSPLAT_ENTRY(GetInputSourceLocalizedName),
    BINOSPLAT_ENTRY(ApplyHapticFeedback),
    BINOSPLAT_ENTRY(StopHapticFeedback),
    BINOSPLAT_ENTRY_OF(GetVisibilityMaskKHR, XR_KHR_VISIBILITY_MASK_EXTENSION_NAME),
};

XrResult XRAPI_CALL get_instance_proc_addr(XrInstance instance, const char* name,
                                           PFN_xrVoidFunction* function) {
  *function = nullptr;
  if (std::strcmp(name, "xrGetInstanceProcAddr") == 0) {
    *function = reinterpret_cast<PFN_xrVoidFunction>(&get_instance_proc_addr);
    return XR_SUCCESS;
  }
  for (const Row& row : table) {
    if (std::strcmp(row.name, name) != 0) continue;
    const Instance* at = runtime().instance();
    if (instance != XR_NULL_HANDLE && row.extension != nullptr &&
        (at == nullptr || at->extensions.count(row.extension) == 0)) {
      break;
    }
    *function = row.function;
    return XR_SUCCESS;
  }
  return XR_ERROR_FUNCTION_UNSUPPORTED;
}

}  // namespace
}  // namespace binosplat::xr_test

extern "C" __attribute__((visibility("default"))) XrResult XRAPI_CALL
xrNegotiateLoaderRuntimeInterface(  // NOLINT(readability-identifier-naming)
    const binosplat::xr_test::LoaderInfo* info, binosplat::xr_test::RuntimeRequest* request) {
  using namespace binosplat::xr_test;
  if (info == nullptr || request == nullptr || info->type != type_loader_info ||
      request->type != type_runtime_request || info->min_interface > interface_version ||
      info->max_interface < interface_version) {
    return XR_ERROR_INITIALIZATION_FAILED;
  }
  try {
    runtime();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "xr_test_runtime: %s\n", error.what());
    return XR_ERROR_INITIALIZATION_FAILED;
  }
  request->interface_version = interface_version;
  request->api_version = XR_CURRENT_API_VERSION;
  request->get = &get_instance_proc_addr;
  return XR_SUCCESS;
}
