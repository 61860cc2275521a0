#pragma once
// Every function that the runtime offers, and its name here: the table of entry points is made of it.

#include <type_traits>

#include "xr/runtime/state.h"

// X(name without xr, function)
#define BINOSPLAT_XR_TEST_FUNCTIONS(X)                                             \
  X(EnumerateInstanceExtensionProperties, enumerate_instance_extension_properties) \
  X(CreateInstance, create_instance)                                               \
  X(DestroyInstance, destroy_instance)                                             \
  X(GetInstanceProperties, get_instance_properties)                                \
  X(PollEvent, poll_event)                                                         \
  X(ResultToString, result_to_string)                                              \
  X(StringToPath, string_to_path)                                                  \
  X(GetSystem, get_system)                                                         \
  X(GetSystemProperties, get_system_properties)                                    \
  X(EnumerateEnvironmentBlendModes, enumerate_environment_blend_modes)             \
  X(EnumerateViewConfigurations, enumerate_view_configurations)                    \
  X(EnumerateViewConfigurationViews, enumerate_view_configuration_views)           \
  X(GetOpenGLGraphicsRequirementsKHR, get_opengl_graphics_requirements)            \
  X(CreateSession, create_session)                                                 \
  X(DestroySession, destroy_session)                                               \
  X(BeginSession, begin_session)                                                   \
  X(EndSession, end_session)                                                       \
  X(RequestExitSession, request_exit_session)                                      \
  X(EnumerateReferenceSpaces, enumerate_reference_spaces)                          \
  X(CreateReferenceSpace, create_reference_space)                                  \
  X(CreateActionSpace, create_action_space)                                        \
  X(LocateSpace, locate_space)                                                     \
  X(DestroySpace, destroy_space)                                                   \
  X(LocateViews, locate_views)                                                     \
  X(EnumerateSwapchainFormats, enumerate_swapchain_formats)                        \
  X(CreateSwapchain, create_swapchain)                                             \
  X(DestroySwapchain, destroy_swapchain)                                           \
  X(EnumerateSwapchainImages, enumerate_swapchain_images)                          \
  X(AcquireSwapchainImage, acquire_swapchain_image)                                \
  X(WaitSwapchainImage, wait_swapchain_image)                                      \
  X(ReleaseSwapchainImage, release_swapchain_image)                                \
  X(WaitFrame, wait_frame)                                                         \
  X(BeginFrame, begin_frame)                                                       \
  X(EndFrame, end_frame)                                                           \
  X(CreateActionSet, create_action_set)                                            \
  X(DestroyActionSet, destroy_action_set)                                          \
  X(CreateAction, create_action)                                                   \
  X(DestroyAction, destroy_action)                                                 \
  X(SuggestInteractionProfileBindings, suggest_interaction_profile_bindings)       \
  X(AttachSessionActionSets, attach_session_action_sets)                           \
  X(GetActionStateBoolean, get_action_state_boolean)                               \
  X(GetActionStateVector2f, get_action_state_vector2f)                             \
  X(GetActionStatePose, get_action_state_pose)                                     \
  X(SyncActions, sync_actions)                                                     \
  X(GetVisibilityMaskKHR, get_visibility_mask)

namespace binosplat::xr_test::api {

// NOLINTNEXTLINE(bugprone-macro-parentheses): the name of what is declared
#define BINOSPLAT_XR_TEST_DECLARE(name, function) std::remove_pointer_t<PFN_xr##name> function;
BINOSPLAT_XR_TEST_FUNCTIONS(BINOSPLAT_XR_TEST_DECLARE)
#undef BINOSPLAT_XR_TEST_DECLARE

}  // namespace binosplat::xr_test::api

namespace binosplat::xr_test {

constexpr XrSystemId the_system = 0x5e7;
const std::vector<ViewSpec>& views_of(XrViewConfigurationType type);
void check_system(XrSystemId system);
void check_pose(const XrPosef& pose);
Pose head_at(XrTime time);
/// Of an action space; none where nobody holds it.
std::optional<Pose> pose_of_action(const Space& space, XrTime time);
/// A path as text. Throws Refusal for one that was never made.
const std::string& text_of(XrPath path);
XrPath path_of(const std::string& text);

/// Whether a controller of an interaction profile has this path, and what it stands for: its value or click
/// where the path names neither. Empty: no.
std::string component_of(const std::string& profile, const std::string& path);
bool is_profile(const std::string& profile);
/// The layers of a frame that ends: checked, logged into `line`, their pictures written.
void check_layers(Session& session, FrameRecord& frame, const XrFrameEndInfo& info, Json& line);

}  // namespace binosplat::xr_test
