#pragma once
// Every function that the runtime offers, by its name without "xr": the table of entry points is made of it.

#include "xr/runtime/state.h"

namespace binosplat::xr_test::api {

XrResult EnumerateInstanceExtensionProperties(const char* layer, std::uint32_t capacity, std::uint32_t* count,
                                              XrExtensionProperties* properties);
XrResult CreateInstance(const XrInstanceCreateInfo* info, XrInstance* out);
XrResult DestroyInstance(XrInstance handle);
XrResult GetInstanceProperties(XrInstance handle, XrInstanceProperties* properties);
XrResult PollEvent(XrInstance handle, XrEventDataBuffer* event);
XrResult ResultToString(XrInstance handle, XrResult value, char* buffer);
XrResult StructureTypeToString(XrInstance handle, XrStructureType value, char* buffer);
XrResult StringToPath(XrInstance handle, const char* text, XrPath* path);
XrResult PathToString(XrInstance handle, XrPath path, std::uint32_t capacity, std::uint32_t* count,
                      char* buffer);

XrResult GetSystem(XrInstance handle, const XrSystemGetInfo* info, XrSystemId* system);
XrResult GetSystemProperties(XrInstance handle, XrSystemId system, XrSystemProperties* properties);
XrResult EnumerateEnvironmentBlendModes(XrInstance handle, XrSystemId system, XrViewConfigurationType type,
                                        std::uint32_t capacity, std::uint32_t* count,
                                        XrEnvironmentBlendMode* modes);
XrResult EnumerateViewConfigurations(XrInstance handle, XrSystemId system, std::uint32_t capacity,
                                     std::uint32_t* count, XrViewConfigurationType* types);
XrResult GetViewConfigurationProperties(XrInstance handle, XrSystemId system, XrViewConfigurationType type,
                                        XrViewConfigurationProperties* properties);
XrResult EnumerateViewConfigurationViews(XrInstance handle, XrSystemId system, XrViewConfigurationType type,
                                         std::uint32_t capacity, std::uint32_t* count,
                                         XrViewConfigurationView* views);
XrResult GetOpenGLGraphicsRequirementsKHR(XrInstance handle, XrSystemId system,
                                          XrGraphicsRequirementsOpenGLKHR* requirements);

XrResult CreateSession(XrInstance handle, const XrSessionCreateInfo* info, XrSession* out);
XrResult DestroySession(XrSession handle);
XrResult BeginSession(XrSession handle, const XrSessionBeginInfo* info);
XrResult EndSession(XrSession handle);
XrResult RequestExitSession(XrSession handle);

XrResult EnumerateReferenceSpaces(XrSession handle, std::uint32_t capacity, std::uint32_t* count,
                                  XrReferenceSpaceType* spaces);
XrResult CreateReferenceSpace(XrSession handle, const XrReferenceSpaceCreateInfo* info, XrSpace* out);
XrResult GetReferenceSpaceBoundsRect(XrSession handle, XrReferenceSpaceType type, XrExtent2Df* bounds);
XrResult CreateActionSpace(XrSession handle, const XrActionSpaceCreateInfo* info, XrSpace* out);
XrResult LocateSpace(XrSpace handle, XrSpace base, XrTime time, XrSpaceLocation* location);
XrResult DestroySpace(XrSpace handle);
XrResult LocateViews(XrSession handle, const XrViewLocateInfo* info, XrViewState* state,
                     std::uint32_t capacity, std::uint32_t* count, XrView* views);

XrResult EnumerateSwapchainFormats(XrSession handle, std::uint32_t capacity, std::uint32_t* count,
                                   std::int64_t* formats);
XrResult CreateSwapchain(XrSession handle, const XrSwapchainCreateInfo* info, XrSwapchain* out);
XrResult DestroySwapchain(XrSwapchain handle);
XrResult EnumerateSwapchainImages(XrSwapchain handle, std::uint32_t capacity, std::uint32_t* count,
                                  XrSwapchainImageBaseHeader* images);
XrResult AcquireSwapchainImage(XrSwapchain handle, const XrSwapchainImageAcquireInfo* info,
                               std::uint32_t* index);
XrResult WaitSwapchainImage(XrSwapchain handle, const XrSwapchainImageWaitInfo* info);
XrResult ReleaseSwapchainImage(XrSwapchain handle, const XrSwapchainImageReleaseInfo* info);

XrResult WaitFrame(XrSession handle, const XrFrameWaitInfo* info, XrFrameState* state);
XrResult BeginFrame(XrSession handle, const XrFrameBeginInfo* info);
XrResult EndFrame(XrSession handle, const XrFrameEndInfo* info);

XrResult CreateActionSet(XrInstance handle, const XrActionSetCreateInfo* info, XrActionSet* out);
XrResult DestroyActionSet(XrActionSet handle);
XrResult CreateAction(XrActionSet handle, const XrActionCreateInfo* info, XrAction* out);
XrResult DestroyAction(XrAction handle);
XrResult SuggestInteractionProfileBindings(XrInstance handle,
                                           const XrInteractionProfileSuggestedBinding* info);
XrResult AttachSessionActionSets(XrSession handle, const XrSessionActionSetsAttachInfo* info);
XrResult GetCurrentInteractionProfile(XrSession handle, XrPath user, XrInteractionProfileState* state);
XrResult GetActionStateBoolean(XrSession handle, const XrActionStateGetInfo* info,
                               XrActionStateBoolean* state);
XrResult GetActionStateFloat(XrSession handle, const XrActionStateGetInfo* info, XrActionStateFloat* state);
XrResult GetActionStateVector2f(XrSession handle, const XrActionStateGetInfo* info,
                                XrActionStateVector2f* state);
XrResult GetActionStatePose(XrSession handle, const XrActionStateGetInfo* info, XrActionStatePose* state);
XrResult SyncActions(XrSession handle, const XrActionsSyncInfo* info);
XrResult EnumerateBoundSourcesForAction(XrSession handle, const XrBoundSourcesForActionEnumerateInfo* info,
                                        std::uint32_t capacity, std::uint32_t* count, XrPath* sources);
XrResult GetInputSourceLocalizedName(XrSession handle, const XrInputSourceLocalizedNameGetInfo* info,
                                     std::uint32_t capacity, std::uint32_t* count, char* buffer);
XrResult ApplyHapticFeedback(XrSession handle, const XrHapticActionInfo* info,
                             const XrHapticBaseHeader* feedback);
XrResult StopHapticFeedback(XrSession handle, const XrHapticActionInfo* info);

XrResult GetVisibilityMaskKHR(XrSession handle, XrViewConfigurationType type, std::uint32_t view,
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
