// The headset, its views, and what its graphics ask for.

#include "xr/runtime/api.h"

namespace binosplat::xr_test {

const std::vector<ViewSpec>& views_of(XrViewConfigurationType type) {
  Runtime& r = runtime();
  const auto found = r.script.views.find(type);
  const bool offered =
      found != r.script.views.end() && (type != XR_VIEW_CONFIGURATION_TYPE_PRIMARY_QUAD_VARJO ||
                                        r.instance()->extensions.count(XR_VARJO_QUAD_VIEWS_EXTENSION_NAME));
  require(offered, XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED,
          "view configuration " + std::to_string(type) + " is not offered, or its extension not enabled");
  return found->second;
}

void check_system(XrSystemId system) {
  require(system == the_system, XR_ERROR_SYSTEM_INVALID, "system " + std::to_string(system));
}

namespace api {

XrResult get_system(XrInstance handle, const XrSystemGetInfo* info, XrSystemId* system) {
  Runtime& r = runtime();
  r.get<Instance>(handle);
  checked(info, XR_TYPE_SYSTEM_GET_INFO);
  require(info->formFactor == XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY, XR_ERROR_FORM_FACTOR_UNSUPPORTED,
          "a head-mounted display is expected");
  if (r.script.system != XR_SUCCESS) throw Refusal{r.script.system, "", false};
  *system = the_system;
  return XR_SUCCESS;
}

XrResult get_system_properties(XrInstance handle, XrSystemId system, XrSystemProperties* properties) {
  const auto& instance = runtime().get<Instance>(handle);
  check_system(system);
  checked(properties, XR_TYPE_SYSTEM_PROPERTIES);
  properties->systemId = system;
  properties->vendorId = 0xb1;
  std::strcpy(properties->systemName, "binosplat's test headset");
  properties->graphicsProperties = {4096, 4096, XR_MIN_COMPOSITION_LAYERS_SUPPORTED};
  properties->trackingProperties = {XR_TRUE, XR_TRUE};
  auto* gaze = chained<XrSystemEyeGazeInteractionPropertiesEXT>(
      properties->next, XR_TYPE_SYSTEM_EYE_GAZE_INTERACTION_PROPERTIES_EXT);
  if (gaze != nullptr) {
    gaze->supportsEyeGazeInteraction =
        instance.extensions.count(XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME) != 0 ? XR_TRUE : XR_FALSE;
  }
  return XR_SUCCESS;
}

XrResult enumerate_environment_blend_modes(XrInstance handle, XrSystemId system, XrViewConfigurationType type,
                                           std::uint32_t capacity, std::uint32_t* count,
                                           XrEnvironmentBlendMode* modes) {
  runtime().get<Instance>(handle);
  check_system(system);
  views_of(type);
  return fill(1, capacity, count, modes, [&](std::size_t) { *modes = XR_ENVIRONMENT_BLEND_MODE_OPAQUE; });
}

XrResult enumerate_view_configurations(XrInstance handle, XrSystemId system, std::uint32_t capacity,
                                       std::uint32_t* count, XrViewConfigurationType* types) {
  const auto& instance = runtime().get<Instance>(handle);
  check_system(system);
  std::vector<XrViewConfigurationType> all;
  for (const auto& [type, views] : runtime().script.views) {
    // The one that shows most comes first, as runtimes prefer it.
    if (type != XR_VIEW_CONFIGURATION_TYPE_PRIMARY_QUAD_VARJO) all.push_back(type);
    if (type == XR_VIEW_CONFIGURATION_TYPE_PRIMARY_QUAD_VARJO &&
        instance.extensions.count(XR_VARJO_QUAD_VIEWS_EXTENSION_NAME) != 0) {
      all.insert(all.begin(), type);
    }
  }
  return fill(all.size(), capacity, count, types, [&](std::size_t k) { types[k] = all[k]; });
}

XrResult enumerate_view_configuration_views(XrInstance handle, XrSystemId system,
                                            XrViewConfigurationType type, std::uint32_t capacity,
                                            std::uint32_t* count, XrViewConfigurationView* views) {
  runtime().get<Instance>(handle);
  check_system(system);
  const std::vector<ViewSpec>& all = views_of(type);
  return fill(all.size(), capacity, count, views, [&](std::size_t k) {
    checked(&views[k], XR_TYPE_VIEW_CONFIGURATION_VIEW);
    views[k].recommendedImageRectWidth = all[k].width;
    views[k].maxImageRectWidth = all[k].max_width;
    views[k].recommendedImageRectHeight = all[k].height;
    views[k].maxImageRectHeight = all[k].max_height;
    views[k].recommendedSwapchainSampleCount = views[k].maxSwapchainSampleCount = 1;
  });
}

XrResult get_opengl_graphics_requirements(XrInstance handle, XrSystemId system,
                                          XrGraphicsRequirementsOpenGLKHR* requirements) {
  auto& instance = runtime().get<Instance>(handle);
  check_system(system);
  checked(requirements, XR_TYPE_GRAPHICS_REQUIREMENTS_OPENGL_KHR);
  requirements->minApiVersionSupported = runtime().script.gl_min;
  requirements->maxApiVersionSupported = runtime().script.gl_max;
  instance.asked_requirements = true;
  return XR_SUCCESS;
}

}  // namespace api
}  // namespace binosplat::xr_test
