// A layer of OpenXR's loader between a program and Khronos' validation. Builds of the validation refuse EGL's
// binding, which they do not know. The layer passes an Xlib binding instead, which the test runtime knows
// (xr/runtime.cpp).

#include <cstdint>
#include <cstring>

#include "xr/bindings.h"

namespace {

// The structs of the loader's specification.
struct LayerInfo;
using CreateInstance = XrResult (*)(const XrInstanceCreateInfo*, const LayerInfo*, XrInstance*);
struct LayerRequest {
  std::uint32_t type, version;
  std::size_t size;
  std::uint32_t interface_version;
  XrVersion api_version;
  PFN_xrGetInstanceProcAddr get;
  CreateInstance create;
};
struct NextInfo {
  std::uint32_t type, version;
  std::size_t size;
  char name[XR_MAX_API_LAYER_NAME_SIZE];
  PFN_xrGetInstanceProcAddr get;
  CreateInstance create;
  NextInfo* next;
};
struct LayerInfo {
  std::uint32_t type, version;
  std::size_t size;
  XrInstance loader_instance;
  char settings[512];
  NextInfo* next;
};

PFN_xrGetInstanceProcAddr next_get = nullptr;
PFN_xrCreateSession next_create_session = nullptr;

XrResult create_session_as_xlib(XrInstance instance, const XrSessionCreateInfo* info, XrSession* session) {
  const auto* egl = static_cast<const XrGraphicsBindingEGLMNDX*>(info->next);
  if (egl == nullptr || egl->type != XR_TYPE_GRAPHICS_BINDING_EGL_MNDX) {
    return next_create_session(instance, info, session);
  }
  const XrGraphicsBindingOpenGLXlibKHR xlib{
      XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR, egl->next, static_cast<Display*>(egl->display),  0,
      static_cast<GLXFBConfig>(egl->config),    0,         static_cast<GLXContext>(egl->context)};
  XrSessionCreateInfo other = *info;
  other.next = &xlib;
  return next_create_session(instance, &other, session);
}

XrResult find_above(XrInstance instance, const char* name, PFN_xrVoidFunction* function) {
  const XrResult result = next_get(instance, name, function);
  if (std::strcmp(name, "xrCreateSession") == 0 && result == XR_SUCCESS) {
    next_create_session = reinterpret_cast<PFN_xrCreateSession>(*function);
    *function = reinterpret_cast<PFN_xrVoidFunction>(create_session_as_xlib);
  }
  return result;
}

XrResult create_instance_below(const XrInstanceCreateInfo* info, const LayerInfo* layer,
                               XrInstance* instance) {
  next_get = layer->next->get;
  LayerInfo below = *layer;
  below.next = layer->next->next;
  return layer->next->create(info, &below, instance);
}

}  // namespace

extern "C" __attribute__((visibility("default"))) XrResult
xrNegotiateLoaderApiLayerInterface(  // NOLINT(readability-identifier-naming): the loader's own name
    const void*, const char*, LayerRequest* request) {
  request->interface_version = 1;
  request->api_version = XR_MAKE_VERSION(1, 0, 0);
  request->get = find_above;
  request->create = create_instance_below;
  return XR_SUCCESS;
}
