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

#define BINOSPLAT_ENTRY_OF(name, function, extension) \
  { name, reinterpret_cast<PFN_xrVoidFunction>(&Entry<Name(name), &api::function>::call), extension }
#define BINOSPLAT_ENTRY(name, function) BINOSPLAT_ENTRY_OF(name, function, nullptr)

const Row table[] = {
    BINOSPLAT_ENTRY("xrEnumerateInstanceExtensionProperties", enumerate_instance_extension_properties),
    BINOSPLAT_ENTRY("xrCreateInstance", create_instance),
    BINOSPLAT_ENTRY("xrDestroyInstance", destroy_instance),
    BINOSPLAT_ENTRY("xrGetInstanceProperties", get_instance_properties),
    BINOSPLAT_ENTRY("xrPollEvent", poll_event),
    BINOSPLAT_ENTRY("xrResultToString", result_to_string),
    BINOSPLAT_ENTRY("xrStructureTypeToString", structure_type_to_string),
    BINOSPLAT_ENTRY("xrStringToPath", string_to_path),
    BINOSPLAT_ENTRY("xrPathToString", path_to_string),
    BINOSPLAT_ENTRY("xrGetSystem", get_system),
    BINOSPLAT_ENTRY("xrGetSystemProperties", get_system_properties),
    BINOSPLAT_ENTRY("xrEnumerateEnvironmentBlendModes", enumerate_environment_blend_modes),
    BINOSPLAT_ENTRY("xrEnumerateViewConfigurations", enumerate_view_configurations),
    BINOSPLAT_ENTRY("xrGetViewConfigurationProperties", get_view_configuration_properties),
    BINOSPLAT_ENTRY("xrEnumerateViewConfigurationViews", enumerate_view_configuration_views),
    BINOSPLAT_ENTRY("xrGetOpenGLGraphicsRequirementsKHR", get_opengl_graphics_requirements),
    BINOSPLAT_ENTRY("xrCreateSession", create_session),
    BINOSPLAT_ENTRY("xrDestroySession", destroy_session),
    BINOSPLAT_ENTRY("xrBeginSession", begin_session),
    BINOSPLAT_ENTRY("xrEndSession", end_session),
    BINOSPLAT_ENTRY("xrRequestExitSession", request_exit_session),
    BINOSPLAT_ENTRY("xrEnumerateReferenceSpaces", enumerate_reference_spaces),
    BINOSPLAT_ENTRY("xrCreateReferenceSpace", create_reference_space),
    BINOSPLAT_ENTRY("xrGetReferenceSpaceBoundsRect", get_reference_space_bounds_rect),
    BINOSPLAT_ENTRY("xrLocateSpace", locate_space),
    BINOSPLAT_ENTRY("xrDestroySpace", destroy_space),
    BINOSPLAT_ENTRY("xrLocateViews", locate_views),
    BINOSPLAT_ENTRY("xrEnumerateSwapchainFormats", enumerate_swapchain_formats),
    BINOSPLAT_ENTRY("xrCreateSwapchain", create_swapchain),
    BINOSPLAT_ENTRY("xrDestroySwapchain", destroy_swapchain),
    BINOSPLAT_ENTRY("xrEnumerateSwapchainImages", enumerate_swapchain_images),
    BINOSPLAT_ENTRY("xrAcquireSwapchainImage", acquire_swapchain_image),
    BINOSPLAT_ENTRY("xrWaitSwapchainImage", wait_swapchain_image),
    BINOSPLAT_ENTRY("xrReleaseSwapchainImage", release_swapchain_image),
    BINOSPLAT_ENTRY("xrWaitFrame", wait_frame),
    BINOSPLAT_ENTRY("xrBeginFrame", begin_frame),
    BINOSPLAT_ENTRY("xrEndFrame", end_frame),
    BINOSPLAT_ENTRY("xrCreateActionSpace", create_action_space),
    BINOSPLAT_ENTRY("xrCreateActionSet", create_action_set),
    BINOSPLAT_ENTRY("xrDestroyActionSet", destroy_action_set),
    BINOSPLAT_ENTRY("xrCreateAction", create_action),
    BINOSPLAT_ENTRY("xrDestroyAction", destroy_action),
    BINOSPLAT_ENTRY("xrSuggestInteractionProfileBindings", suggest_interaction_profile_bindings),
    BINOSPLAT_ENTRY("xrAttachSessionActionSets", attach_session_action_sets),
    BINOSPLAT_ENTRY("xrGetCurrentInteractionProfile", get_current_interaction_profile),
    BINOSPLAT_ENTRY("xrGetActionStateBoolean", get_action_state_boolean),
    BINOSPLAT_ENTRY("xrGetActionStateFloat", get_action_state_float),
    BINOSPLAT_ENTRY("xrGetActionStateVector2f", get_action_state_vector2f),
    BINOSPLAT_ENTRY("xrGetActionStatePose", get_action_state_pose),
    BINOSPLAT_ENTRY("xrSyncActions", sync_actions),
    BINOSPLAT_ENTRY("xrEnumerateBoundSourcesForAction", enumerate_bound_sources_for_action),
    BINOSPLAT_ENTRY("xrGetInputSourceLocalizedName", get_input_source_localized_name),
    BINOSPLAT_ENTRY("xrApplyHapticFeedback", apply_haptic_feedback),
    BINOSPLAT_ENTRY("xrStopHapticFeedback", stop_haptic_feedback),
    BINOSPLAT_ENTRY_OF("xrGetVisibilityMaskKHR", get_visibility_mask, XR_KHR_VISIBILITY_MASK_EXTENSION_NAME),
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
