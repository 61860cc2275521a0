#include "xr/openxr.h"

#include <dlfcn.h>
#include <openxr/openxr_reflection.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <set>

namespace binosplat::xr {

namespace {

constexpr const char* what_to_do =
    "Install one for the headset, such as Monado or SteamVR, start it, and make it the active one "
    "(~/.config/openxr/1/active_runtime.json, or the variable XR_RUNTIME_JSON)";

// Enabled if the runtime has them. The headers of Debian 12 do not define the floor extension.
constexpr std::array optional_extensions = {"XR_MNDX_egl_enable",
                                            XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME,
                                            XR_KHR_VISIBILITY_MASK_EXTENSION_NAME,
                                            XR_VARJO_QUAD_VIEWS_EXTENSION_NAME,
                                            XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME,
                                            "XR_EXT_local_floor"};

void* open_loader() {
  setenv("XR_LOADER_DEBUG", "none", 0);  // the errors below replace the loader's messages
  void* const library = dlopen("libopenxr_loader.so.1", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    refuse(
        "no OpenXR loader ({}). On Debian: apt install libopenxr-loader1, and a runtime for the headset, "
        "such as Monado or SteamVR",
        dlerror());
  }
  return library;
}

std::set<std::string> offered_extensions() {
  std::vector<XrExtensionProperties> all;
  const auto enumerate = [](std::uint32_t capacity, std::uint32_t* count, XrExtensionProperties* list) {
    const XrResult result = XR_CALL(EnumerateInstanceExtensionProperties, nullptr, capacity, count, list);
    if (XR_SUCCEEDED(result)) return;
    const char* const named = std::getenv("XR_RUNTIME_JSON");
    refuse("no OpenXR runtime ({}){}. {}", name_of(result),
           named == nullptr ? "" : fmt::format(" by XR_RUNTIME_JSON={}", named), what_to_do);
  };
  std::set<std::string> names;
  for (const auto& extension : all_of(XrExtensionProperties{XR_TYPE_EXTENSION_PROPERTIES}, enumerate))
    names.insert(extension.extensionName);
  return names;
}

}  // namespace

PFN_xrVoidFunction find(const char* name) {
  static void* const library = open_loader();
  void* const function = dlsym(library, name);
  if (function == nullptr) refuse("libopenxr_loader.so.1 has no {}: it is not an OpenXR loader", name);
  return reinterpret_cast<PFN_xrVoidFunction>(function);
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

XrResult check(XrResult result, const char* call) {
  if (result == XR_ERROR_SESSION_LOST) throw Lost{};
  if (result == XR_ERROR_INSTANCE_LOST) throw Lost{.instance = true};
  if (XR_FAILED(result)) refuse("OpenXR: {} failed: {}", call, name_of(result));
  return result;
}

Instance::Instance(bool passthrough) {
  const std::set<std::string> offered = offered_extensions();
  extensions.push_back(XR_KHR_OPENGL_ENABLE_EXTENSION_NAME);
  if (!offered.contains(extensions.front())) {
    refuse("this OpenXR runtime takes no OpenGL ({} is missing): choose another, such as Monado or SteamVR",
           extensions.front());
  }
  for (const char* name : optional_extensions) {
    if (offered.contains(name)) extensions.push_back(name);
  }
  try {
    connect();
    if (passthrough) show_room();
  } catch (const Lost&) {
    refuse("the OpenXR runtime ended: start it, then start binosplat again");
  }
}

void Instance::connect() {
  XrInstanceCreateInfo info{XR_TYPE_INSTANCE_CREATE_INFO};
  info.applicationInfo = {"binosplat", 1, "binosplat", 1, XR_MAKE_VERSION(1, 0, 0)};
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.enabledExtensionNames = extensions.data();
  XrInstance made = XR_NULL_HANDLE;
  const XrResult result = XR_CALL(CreateInstance, &info, &made);
  if (XR_FAILED(result)) refuse("the OpenXR runtime does not start ({}). {}", name_of(result), what_to_do);
  handle = Owned<XrInstance>(made, {"xrDestroyInstance"});
  XrInstanceProperties properties{XR_TYPE_INSTANCE_PROPERTIES};
  XR(GetInstanceProperties, made, &properties);
  const XrVersion version = properties.runtimeVersion;
  runtime = fmt::format("{} {}.{}.{}", properties.runtimeName, XR_VERSION_MAJOR(version),
                        XR_VERSION_MINOR(version), XR_VERSION_PATCH(version));
  const XrResult found = find_headset();
  if (found == XR_ERROR_FORM_FACTOR_UNAVAILABLE || found == XR_ERROR_FORM_FACTOR_UNSUPPORTED)
    refuse("{} has no headset ({}): connect it and switch it on", runtime, name_of(found));
  check(found, "xrGetSystem");
  XrSystemProperties named{XR_TYPE_SYSTEM_PROPERTIES};
  XR(GetSystemProperties, made, system, &named);
  headset = named.systemName;
  const auto offered = all_of<XrViewConfigurationType>({}, [&](auto capacity, auto* count, auto* all) {
    XR(EnumerateViewConfigurations, made, system, capacity, count, all);
  });
  const auto offers = [&](auto type) { return std::ranges::find(offered, type) != offered.end(); };
  if (has(XR_VARJO_QUAD_VIEWS_EXTENSION_NAME) && offers(XR_VIEW_CONFIGURATION_TYPE_PRIMARY_QUAD_VARJO))
    views = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_QUAD_VARJO;
  else if (!offers(views))
    refuse("{} does not show two eyes: expected a stereo headset", headset);
}

void Instance::show_room() {
  const auto offered = all_of<XrEnvironmentBlendMode>({}, [&](auto capacity, auto* count, auto* all) {
    XR(EnumerateEnvironmentBlendModes, handle.get(), system, views, capacity, count, all);
  });
  // The later one is better: it keeps dark colours.
  for (const auto mode : {XR_ENVIRONMENT_BLEND_MODE_ADDITIVE, XR_ENVIRONMENT_BLEND_MODE_ALPHA_BLEND})
    if (std::ranges::find(offered, mode) != offered.end()) blend_mode = mode;
  if (blend_mode == XR_ENVIRONMENT_BLEND_MODE_OPAQUE) {
    refuse(
        "`passthrough`: {} shows no room behind pictures on {}: expected OpenXR's blend mode ALPHA_BLEND or "
        "ADDITIVE. Switch passthrough on in the runtime, or leave the setting out",
        runtime, headset);
  }
}

XrResult Instance::find_headset() {
  const XrSystemGetInfo wanted{XR_TYPE_SYSTEM_GET_INFO, nullptr, XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY};
  return XR_CALL(GetSystem, handle.get(), &wanted, &system);
}

XrPath Instance::path(const std::string& text) const {
  XrPath path = XR_NULL_PATH;
  XR(StringToPath, handle.get(), text.c_str(), &path);
  return path;
}

}  // namespace binosplat::xr
