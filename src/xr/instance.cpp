#include "xr/instance.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>

#include "base/error.h"
#include "xr/binding.h"

namespace binosplat::xr {

namespace {

constexpr const char* what_to_do =
    "Install one for the headset, such as SteamVR or Monado, start it, and make it the active one "
    "(~/.config/openxr/1/active_runtime.json, or the variable XR_RUNTIME_JSON)";

// Asked for where the runtime has them. Floors came to OpenXR as an extension, later than Debian 12's
// headers.
constexpr std::array optional_extensions = {
    egl_extension,
    XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME,
    XR_KHR_VISIBILITY_MASK_EXTENSION_NAME,
    XR_VARJO_QUAD_VIEWS_EXTENSION_NAME,
    XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME,
    "XR_EXT_local_floor",
};

// Where the environment names a runtime, it is that one.
std::string asked_for() {
  const char* const named = std::getenv("XR_RUNTIME_JSON");
  return named == nullptr ? "" : fmt::format(" by XR_RUNTIME_JSON={}", named);
}

std::set<std::string> offered_extensions() {
  std::set<std::string> names;
  XrExtensionProperties empty{};
  empty.type = XR_TYPE_EXTENSION_PROPERTIES;
  std::uint32_t count = 0;
  const auto enumerate = loader().EnumerateInstanceExtensionProperties;
  const XrResult result = enumerate(nullptr, 0, &count, nullptr);
  if (XR_FAILED(result))
    throw Error(ExitCode::no_gl,
                fmt::format("no OpenXR runtime ({}){}. {}", name_of(result), asked_for(), what_to_do));
  std::vector<XrExtensionProperties> all(count, empty);
  check(enumerate(nullptr, count, &count, all.data()), "xrEnumerateInstanceExtensionProperties");
  for (const XrExtensionProperties& extension : all) names.insert(extension.extensionName);
  return names;
}

}  // namespace

Instance::Instance() {
  const std::set<std::string> offered = offered_extensions();
  if (!offered.contains(opengl_extension))
    throw Error(ExitCode::no_gl,
                fmt::format("this OpenXR runtime takes no OpenGL ({} is missing): choose another runtime",
                            opengl_extension));
  extensions_.insert(opengl_extension);
  for (const char* name : optional_extensions) {
    if (offered.contains(name)) extensions_.insert(name);
  }
  std::vector<const char*> names;
  for (const std::string& name : extensions_) names.push_back(name.c_str());
  XrInstanceCreateInfo info{XR_TYPE_INSTANCE_CREATE_INFO};
  std::strcpy(info.applicationInfo.applicationName, "binosplat");
  std::strcpy(info.applicationInfo.engineName, "binosplat");
  info.applicationInfo.applicationVersion = info.applicationInfo.engineVersion = 1;
  info.applicationInfo.apiVersion = XR_MAKE_VERSION(1, 0, 0);
  info.enabledExtensionCount = static_cast<std::uint32_t>(names.size());
  info.enabledExtensionNames = names.data();
  const XrResult result = loader().CreateInstance(&info, &instance_);
  if (XR_FAILED(result))
    throw Error(ExitCode::no_gl,
                fmt::format("the OpenXR runtime does not start ({}). {}", name_of(result), what_to_do));
  try {
    find_headset();
  } catch (...) {
    if (api_.DestroyInstance != nullptr) api_.DestroyInstance(instance_);
    throw;
  }
}

Instance::~Instance() { api_.DestroyInstance(instance_); }

void Instance::find_headset() {
  api_ = load_api(instance_);
  XrInstanceProperties properties{XR_TYPE_INSTANCE_PROPERTIES};
  check(api_.GetInstanceProperties(instance_, &properties), "xrGetInstanceProperties");
  const XrVersion version = properties.runtimeVersion;
  runtime_ = fmt::format("{} {}.{}.{}", properties.runtimeName, XR_VERSION_MAJOR(version),
                         XR_VERSION_MINOR(version), XR_VERSION_PATCH(version));
  const XrResult found = get_system();
  if (found == XR_ERROR_FORM_FACTOR_UNAVAILABLE || found == XR_ERROR_FORM_FACTOR_UNSUPPORTED)
    throw Error(ExitCode::no_gl,
                fmt::format("{} has no headset ({}): connect it and switch it on", runtime_, name_of(found)));
  check(found, "xrGetSystem");
  XrSystemProperties system{XR_TYPE_SYSTEM_PROPERTIES};
  check(api_.GetSystemProperties(instance_, system_, &system), "xrGetSystemProperties");
  headset_ = system.systemName;
  const auto configurations = all_of<XrViewConfigurationType>(
      "xrEnumerateViewConfigurations", {}, [&](std::uint32_t room, std::uint32_t* count, auto* all) {
        return api_.EnumerateViewConfigurations(instance_, system_, room, count, all);
      });
  const auto offers = [&](XrViewConfigurationType type) {
    return std::find(configurations.begin(), configurations.end(), type) != configurations.end();
  };
  if (has(XR_VARJO_QUAD_VIEWS_EXTENSION_NAME) && offers(XR_VIEW_CONFIGURATION_TYPE_PRIMARY_QUAD_VARJO))
    view_configuration_ = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_QUAD_VARJO;
  else if (!offers(view_configuration_))
    throw Error(ExitCode::no_gl, fmt::format("{} shows no two eyes: it is no stereo headset", headset_));
}

XrResult Instance::get_system() {
  XrSystemGetInfo wanted{XR_TYPE_SYSTEM_GET_INFO};
  wanted.formFactor = XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY;
  return api_.GetSystem(instance_, &wanted, &system_);
}

bool Instance::find_again() { return XR_SUCCEEDED(get_system()); }

std::vector<XrViewConfigurationView> Instance::views() const {
  XrViewConfigurationView empty{};
  empty.type = XR_TYPE_VIEW_CONFIGURATION_VIEW;
  return all_of("xrEnumerateViewConfigurationViews", empty,
                [&](std::uint32_t room, std::uint32_t* count, XrViewConfigurationView* all) {
                  return api_.EnumerateViewConfigurationViews(instance_, system_, view_configuration_, room,
                                                              count, all);
                });
}

XrEnvironmentBlendMode Instance::blend_mode() const {
  const auto modes = all_of<XrEnvironmentBlendMode>(
      "xrEnumerateEnvironmentBlendModes", {}, [&](std::uint32_t room, std::uint32_t* count, auto* all) {
        return api_.EnumerateEnvironmentBlendModes(instance_, system_, view_configuration_, room, count, all);
      });
  // The runtime's favourite, unless it can hide the room around.
  const bool opaque = std::find(modes.begin(), modes.end(), XR_ENVIRONMENT_BLEND_MODE_OPAQUE) != modes.end();
  return opaque || modes.empty() ? XR_ENVIRONMENT_BLEND_MODE_OPAQUE : modes.front();
}

XrPath Instance::path(const std::string& text) const {
  XrPath path = XR_NULL_PATH;
  check(api_.StringToPath(instance_, text.c_str(), &path), "xrStringToPath");
  return path;
}

}  // namespace binosplat::xr
