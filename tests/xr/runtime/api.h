#pragma once
// Every function that the runtime offers, by its name in snake case: the table of entry points is made of it.

#include "xr/runtime/state.h"

namespace binosplat::xr_test::api {

XrResult enumerate_instance_extension_properties(const char* layer, std::uint32_t capacity,
                                                 std::uint32_t* count, XrExtensionProperties* properties);
XrResult create_instance(const XrInstanceCreateInfo* info, XrInstance* out);
XrResult destroy_instance(XrInstance handle);
XrResult get_instance_properties(XrInstance handle, XrInstanceProperties* properties);
XrResult poll_event(XrInstance handle, XrEventDataBuffer* event);
XrResult result_to_string(XrInstance handle, XrResult value, char* buffer);
XrResult structure_type_to_string(XrInstance handle, XrStructureType value, char* buffer);
XrResult string_to_path(XrInstance handle, const char* text, XrPath* path);
XrResult path_to_string(XrInstance handle, XrPath path, std::uint32_t capacity, std::uint32_t* count,
                        char* buffer);

XrResult get_system(XrInstance handle, const XrSystemGetInfo* info, XrSystemId* system);
XrResult get_system_properties(XrInstance handle, XrSystemId system, XrSystemProperties* properties);
XrResult enumerate_environment_blend_modes(XrInstance handle, XrSystemId system, XrViewConfigurationType type,
                                           std::uint32_t capacity, std::uint32_t* count,
                                           XrEnvironmentBlendMode* modes);
XrResult enumerate_view_configurations(XrInstance handle, XrSystemId system, std::uint32_t capacity,
                                       std::uint32_t* count, XrViewConfigurationType* types);
XrResult get_view_configuration_properties(XrInstance handle, XrSystemId system, XrViewConfigurationType type,
                                           XrViewConfigurationProperties* properties);
XrResult enumerate_view_configuration_views(XrInstance handle, XrSystemId system,
                                            XrViewConfigurationType type, std::uint32_t capacity,
                                            std::uint32_t* count, XrViewConfigurationView* views);
XrResult get_opengl_graphics_requirements(XrInstance handle, XrSystemId system,
                                          XrGraphicsRequirementsOpenGLKHR* requirements);

XrResult create_session(XrInstance handle, const XrSessionCreateInfo* info, XrSession* out);
XrResult destroy_session(XrSession handle);
XrResult begin_session(XrSession handle, const XrSessionBeginInfo* info);
XrResult end_session(XrSession handle);
XrResult request_exit_session(XrSession handle);

XrResult enumerate_reference_spaces(XrSession handle, std::uint32_t capacity, std::uint32_t* count,
                                    XrReferenceSpaceType* spaces);
XrResult create_reference_space(XrSession handle, const XrReferenceSpaceCreateInfo* info, XrSpace* out);
XrResult get_reference_space_bounds_rect(XrSession handle, XrReferenceSpaceType type, XrExtent2Df* bounds);
XrResult create_action_space(XrSession handle, const XrActionSpaceCreateInfo* info, XrSpace* out);
XrResult locate_space(XrSpace handle, XrSpace base, XrTime time, XrSpaceLocation* location);
XrResult destroy_space(XrSpace handle);
XrResult locate_views(XrSession handle, const XrViewLocateInfo* info, XrViewState* state,
                      std::uint32_t capacity, std::uint32_t* count, XrView* views);

XrResult enumerate_swapchain_formats(XrSession handle, std::uint32_t capacity, std::uint32_t* count,
                                     std::int64_t* formats);
XrResult create_swapchain(XrSession handle, const XrSwapchainCreateInfo* info, XrSwapchain* out);
XrResult destroy_swapchain(XrSwapchain handle);
XrResult enumerate_swapchain_images(XrSwapchain handle, std::uint32_t capacity, std::uint32_t* count,
                                    XrSwapchainImageBaseHeader* images);
XrResult acquire_swapchain_image(XrSwapchain handle, const XrSwapchainImageAcquireInfo* info,
                                 std::uint32_t* index);
XrResult wait_swapchain_image(XrSwapchain handle, const XrSwapchainImageWaitInfo* info);
XrResult release_swapchain_image(XrSwapchain handle, const XrSwapchainImageReleaseInfo* info);

XrResult wait_frame(XrSession handle, const XrFrameWaitInfo* info, XrFrameState* state);
XrResult begin_frame(XrSession handle, const XrFrameBeginInfo* info);
XrResult end_frame(XrSession handle, const XrFrameEndInfo* info);

XrResult create_action_set(XrInstance handle, const XrActionSetCreateInfo* info, XrActionSet* out);
XrResult destroy_action_set(XrActionSet handle);
XrResult create_action(XrActionSet handle, const XrActionCreateInfo* info, XrAction* out);
XrResult destroy_action(XrAction handle);
XrResult suggest_interaction_profile_bindings(XrInstance handle,
                                              const XrInteractionProfileSuggestedBinding* info);
XrResult attach_session_action_sets(XrSession handle, const XrSessionActionSetsAttachInfo* info);
XrResult get_current_interaction_profile(XrSession handle, XrPath user, XrInteractionProfileState* state);
XrResult get_action_state_boolean(XrSession handle, const XrActionStateGetInfo* info,
                                  XrActionStateBoolean* out);
XrResult get_action_state_float(XrSession handle, const XrActionStateGetInfo* info, XrActionStateFloat* out);
XrResult get_action_state_vector2f(XrSession handle, const XrActionStateGetInfo* info,
                                   XrActionStateVector2f* out);
XrResult get_action_state_pose(XrSession handle, const XrActionStateGetInfo* info, XrActionStatePose* out);
XrResult sync_actions(XrSession handle, const XrActionsSyncInfo* info);
XrResult enumerate_bound_sources_for_action(XrSession handle,
                                            const XrBoundSourcesForActionEnumerateInfo* info,
                                            std::uint32_t capacity, std::uint32_t* count, XrPath* sources);
XrResult get_input_source_localized_name(XrSession handle, const XrInputSourceLocalizedNameGetInfo* info,
                                         std::uint32_t capacity, std::uint32_t* count, char* buffer);
XrResult apply_haptic_feedback(XrSession handle, const XrHapticActionInfo* info,
                               const XrHapticBaseHeader* feedback);
XrResult stop_haptic_feedback(XrSession handle, const XrHapticActionInfo* info);

XrResult get_visibility_mask(XrSession handle, XrViewConfigurationType type, std::uint32_t view,
                             XrVisibilityMaskTypeKHR mask_type, XrVisibilityMaskKHR* mask);

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
