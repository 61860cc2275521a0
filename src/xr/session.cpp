#include "xr/session.h"

#include <dlfcn.h>

#include <algorithm>

#include "base/log.h"

namespace binosplat::xr {

namespace {

// From XR_EXT_local_floor, which the headers of Debian 12 lack.
constexpr auto local_floor = static_cast<XrReferenceSpaceType>(1000426000);

constexpr const char* state_names[] = {"UNKNOWN", "IDLE",     "READY",        "SYNCHRONIZED", "VISIBLE",
                                       "FOCUSED", "STOPPING", "LOSS_PENDING", "EXITING"};

// A function of EGL or GLX, if the creator of the context has opened the library; else null.
template <typename Function>
Function opened(const char* from, const char* name) {
  void* const library = dlopen(from, RTLD_NOW | RTLD_LOCAL | RTLD_NOLOAD);
  if (library == nullptr) return nullptr;
  const auto function = reinterpret_cast<Function>(dlsym(library, name));
  dlclose(library);  // the opener keeps it loaded
  return function;
}
#define OPENED(name) opened<decltype(&(name))>("libEGL.so.1", #name)
template <typename Result>
Result current_of_glx(const char* name) {
  const auto get = opened<Result (*)()>("libGLX.so.0", name);
  return get == nullptr ? Result{} : get();
}

std::optional<XrGraphicsBindingEGLMNDX> egl_binding() {
  const auto current = OPENED(eglGetCurrentContext);
  XrGraphicsBindingEGLMNDX binding{XR_TYPE_GRAPHICS_BINDING_EGL_MNDX};
  binding.context = current == nullptr ? EGL_NO_CONTEXT : current();
  if (binding.context == EGL_NO_CONTEXT) return std::nullopt;
  binding.getProcAddress = opened<PFNEGLGETPROCADDRESSPROC>("libEGL.so.1", "eglGetProcAddress");
  binding.display = OPENED(eglGetCurrentDisplay)();
  EGLint id = 0, count = 0;  // config of the context; 0: the context has none
  OPENED(eglQueryContext)(binding.display, binding.context, EGL_CONFIG_ID, &id);
  const EGLint wanted[] = {EGL_CONFIG_ID, id, EGL_NONE};
  if (id != 0) OPENED(eglChooseConfig)(binding.display, wanted, &binding.config, 1, &count);
  return binding;
}

// Runtimes ignore the visual and the config.
XrGraphicsBindingOpenGLXlibKHR xlib_binding() {
  XrGraphicsBindingOpenGLXlibKHR binding{XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR};
  binding.xDisplay = current_of_glx<Display*>("glXGetCurrentDisplay");
  binding.glxDrawable = current_of_glx<GLXDrawable>("glXGetCurrentDrawable");
  binding.glxContext = current_of_glx<GLXContext>("glXGetCurrentContext");
  return binding;
}

}  // namespace

GetProcAddress get_proc_address() {
  const auto egl = egl_binding();
  return egl ? egl->getProcAddress : opened<GetProcAddress>("libGLX.so.0", "glXGetProcAddress");
}

Session::Session(const Instance& instance) : instance_(instance) {
  // OpenXR requires this call before a session. Its result is unused: drivers provide newer contexts anyway.
  const auto ask =
      instance.function<PFN_xrGetOpenGLGraphicsRequirementsKHR>("xrGetOpenGLGraphicsRequirementsKHR");
  XrGraphicsRequirementsOpenGLKHR range{XR_TYPE_GRAPHICS_REQUIREMENTS_OPENGL_KHR};
  check(ask(instance.handle.get(), instance.system, &range), "xrGetOpenGLGraphicsRequirementsKHR");
  const auto egl = egl_binding();
  const XrGraphicsBindingOpenGLXlibKHR xlib = xlib_binding();
  const XrSessionCreateInfo info{XR_TYPE_SESSION_CREATE_INFO, egl ? static_cast<const void*>(&*egl) : &xlib,
                                 0, instance.system};
  XrSession made = XR_NULL_HANDLE;
  const XrResult result = XR_CALL(CreateSession, instance.handle.get(), &info, &made);
  if (result == XR_ERROR_GRAPHICS_DEVICE_INVALID) {
    refuse(
        "{} does not take this OpenGL context ({}): some runtimes want the GPU that the headset is connected "
        "to (`device`)",
        instance.runtime, name_of(result));
  }
  check(result, "xrCreateSession");
  session_ = Owned<XrSession>(made, {"xrDestroySession"});
  make_space();
}

void Session::make_space() {
  const auto spaces = all_of<XrReferenceSpaceType>({}, [&](auto capacity, auto* count, auto* all) {
    XR(EnumerateReferenceSpaces, handle(), capacity, count, all);
  });
  for (const XrReferenceSpaceType better : {XR_REFERENCE_SPACE_TYPE_STAGE, local_floor}) {
    if (std::ranges::find(spaces, better) != spaces.end()) space_type_ = better;
  }
  const XrReferenceSpaceCreateInfo info{XR_TYPE_REFERENCE_SPACE_CREATE_INFO, nullptr, space_type_, no_move};
  space_ = XR_OWNED(Space, CreateReferenceSpace, handle(), &info);
}

bool Session::poll() {
  XrEventDataBuffer event{XR_TYPE_EVENT_DATA_BUFFER};
  while (!over_ && XR(PollEvent, instance_.handle.get(), &event) == XR_SUCCESS) {
    if (event.type == XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING) throw Lost{.instance = true};
    if (event.type == XR_TYPE_EVENT_DATA_VISIBILITY_MASK_CHANGED_KHR) masks_changed_ = true;
    if (event.type == XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED)
      follow(reinterpret_cast<const XrEventDataSessionStateChanged&>(event));
    event = {XR_TYPE_EVENT_DATA_BUFFER};
  }
  return !over_;
}

void Session::follow(const XrEventDataSessionStateChanged& event) {
  if (event.session != handle()) return;
  if (event.state >= 0 && static_cast<std::size_t>(event.state) < std::size(state_names))
    log_info("headset: {}", state_names[event.state]);
  if (event.state == XR_SESSION_STATE_READY) {
    const XrSessionBeginInfo info{XR_TYPE_SESSION_BEGIN_INFO, nullptr, instance_.views};
    XR(BeginSession, handle(), &info);
    running_ = true;
  } else if (event.state == XR_SESSION_STATE_STOPPING) {
    running_ = false;
    XR(EndSession, handle());
  } else if (event.state == XR_SESSION_STATE_LOSS_PENDING) {
    throw Lost{};
  }
  over_ = event.state == XR_SESSION_STATE_EXITING;
}

void Session::request_exit() {
  if (running_) XR(RequestExitSession, handle());
  over_ = !running_;
}

XrFrameState Session::begin_frame() const {
  XrFrameState state{XR_TYPE_FRAME_STATE};
  XR(WaitFrame, handle(), nullptr, &state);
  XR(BeginFrame, handle(), nullptr);
  return state;
}

std::vector<XrView> Session::locate(XrTime display) const {
  const XrViewLocateInfo info{XR_TYPE_VIEW_LOCATE_INFO, nullptr, instance_.views, display, space()};
  XrViewState state{XR_TYPE_VIEW_STATE};
  std::vector<XrView> views = all_of(XrView{XR_TYPE_VIEW}, [&](auto capacity, auto* count, auto* all) {
    XR(LocateViews, handle(), &info, &state, capacity, count, all);
  });
  constexpr XrViewStateFlags valid = XR_VIEW_STATE_ORIENTATION_VALID_BIT | XR_VIEW_STATE_POSITION_VALID_BIT;
  if ((state.viewStateFlags & valid) != valid || views.size() < 2) views.clear();
  return views;
}

std::optional<XrPosef> Session::locate(XrSpace other, XrTime display) const {
  XrSpaceLocation location{XR_TYPE_SPACE_LOCATION};
  XR(LocateSpace, other, space(), display, &location);
  constexpr XrSpaceLocationFlags valid =
      XR_SPACE_LOCATION_ORIENTATION_VALID_BIT | XR_SPACE_LOCATION_POSITION_VALID_BIT;
  if ((location.locationFlags & valid) != valid) return std::nullopt;
  return location.pose;
}

void Session::end_frame(XrTime display, const XrCompositionLayerProjection* layer) const {
  const auto* const layers = reinterpret_cast<const XrCompositionLayerBaseHeader*>(layer);
  const XrFrameEndInfo info{XR_TYPE_FRAME_END_INFO,     nullptr, display, instance_.blend_mode,
                            layer == nullptr ? 0u : 1u, &layers};
  XR(EndFrame, handle(), &info);
}

}  // namespace binosplat::xr
