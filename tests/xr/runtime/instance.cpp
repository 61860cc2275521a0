// The instance, its events and its names.

#include <algorithm>

#include "xr/runtime/api.h"

namespace binosplat::xr_test {

const std::string& text_of(XrPath path) {
  const auto& paths = runtime().paths;
  const auto found = paths.find(path);
  require(found != paths.end(), XR_ERROR_PATH_INVALID, "path " + std::to_string(path) + " was never made");
  return found->second;
}

XrPath path_of(const std::string& text) {
  auto& paths = runtime().paths;
  for (const auto& [path, known] : paths) {
    if (known == text) return path;
  }
  paths[paths.size() + 1] = text;
  return paths.size();
}

namespace api {

XrResult enumerate_instance_extension_properties(const char* layer, std::uint32_t capacity,
                                                 std::uint32_t* count, XrExtensionProperties* properties) {
  require(layer == nullptr, XR_ERROR_API_LAYER_NOT_PRESENT, "a runtime has no layers");
  const auto& all = runtime().script.extensions;
  const std::vector<std::string> names(all.begin(), all.end());
  return fill(names.size(), capacity, count, properties, [&](std::size_t k) {
    checked(&properties[k], XR_TYPE_EXTENSION_PROPERTIES);
    std::strncpy(properties[k].extensionName, names[k].c_str(), XR_MAX_EXTENSION_NAME_SIZE - 1);
    properties[k].extensionVersion = 1;
  });
}

XrResult create_instance(const XrInstanceCreateInfo* info, XrInstance* out) {
  checked(info, XR_TYPE_INSTANCE_CREATE_INFO);
  Runtime& r = runtime();
  require(r.instance() == nullptr, XR_ERROR_LIMIT_REACHED, "a second instance");
  require(XR_VERSION_MAJOR(info->applicationInfo.apiVersion) == 1 &&
              XR_VERSION_MINOR(info->applicationInfo.apiVersion) == 0,
          XR_ERROR_API_VERSION_UNSUPPORTED, "OpenXR 1.0 is expected");
  require(info->applicationInfo.applicationName[0] != '\0', XR_ERROR_NAME_INVALID,
          "the application has no name");
  std::set<std::string> extensions;
  for (std::uint32_t k = 0; k < info->enabledExtensionCount; ++k) {
    const std::string name = info->enabledExtensionNames[k];
    // The loader, not the runtime, knows what layers offer.
    require(r.script.extensions.count(name) != 0, XR_ERROR_EXTENSION_NOT_PRESENT, name + " is not offered");
    extensions.insert(name);
  }
  auto& instance = r.add<Instance>(0);
  instance.extensions = extensions;
  *out = handle_of<XrInstance>(instance);
  r.log({{"what", "instance"},
         {"application", info->applicationInfo.applicationName},
         {"extensions", instance.extensions}});
  return XR_SUCCESS;
}

XrResult destroy_instance(XrInstance handle) {
  runtime().destroy(runtime().get<Instance>(handle, true));
  return XR_SUCCESS;
}

XrResult get_instance_properties(XrInstance handle, XrInstanceProperties* properties) {
  runtime().get<Instance>(handle);
  checked(properties, XR_TYPE_INSTANCE_PROPERTIES);
  properties->runtimeVersion = XR_MAKE_VERSION(1, 0, 0);
  std::strcpy(properties->runtimeName, "binosplat's test runtime");
  return XR_SUCCESS;
}

XrResult poll_event(XrInstance handle, XrEventDataBuffer* event) {
  auto& instance = runtime().get<Instance>(handle);
  checked(event, XR_TYPE_EVENT_DATA_BUFFER);
  if (instance.events.empty()) return XR_EVENT_UNAVAILABLE;
  *event = instance.events.front();
  instance.events.pop_front();
  return XR_SUCCESS;
}

XrResult result_to_string(XrInstance handle, XrResult value, char* buffer) {
  runtime().get<Instance>(handle, true);
  std::strncpy(buffer, name_of(value), XR_MAX_RESULT_STRING_SIZE - 1);
  return XR_SUCCESS;
}

XrResult string_to_path(XrInstance handle, const char* text, XrPath* path) {
  Runtime& r = runtime();
  r.get<Instance>(handle);
  const std::string name = text == nullptr ? "" : text;
  const bool good = name.size() > 1 && name.size() < XR_MAX_PATH_LENGTH && name[0] == '/' &&
                    name.back() != '/' && name.find("//") == std::string::npos &&
                    name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-_./") == std::string::npos;
  require(good, XR_ERROR_PATH_FORMAT_INVALID, "'" + name + "' is no path");
  *path = path_of(name);
  return XR_SUCCESS;
}

}  // namespace api
}  // namespace binosplat::xr_test
