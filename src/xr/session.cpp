#include "xr/session.h"

#include <dlfcn.h>

#include <algorithm>

#include "base/log.h"
#include "xr/platform.h"

namespace binosplat::xr {

namespace {

// Of XR_EXT_local_floor, which Debian 12's headers do not know yet.
constexpr auto local_floor = static_cast<XrReferenceSpaceType>(1000426000);

constexpr const char* state_names[] = {"UNKNOWN", "IDLE",     "READY",        "SYNCHRONIZED", "VISIBLE",
                                       "FOCUSED", "STOPPING", "LOSS_PENDING", "EXITING"};

// Of a library that whoever made the context has opened; null if nobody has.
template <typename Function>
Function opened(const char* library, const char* name) {
  void* const handle = dlopen(library, RTLD_NOW | RTLD_LOCAL | RTLD_NOLOAD);
  if (handle == nullptr) return nullptr;
  const auto function = reinterpret_cast<Function>(dlsym(handle, name));
  dlclose(handle);  // whoever opened it keeps it
  return function;
}
#define OPENED(library, name) opened<decltype(&(name))>(library, #name)

// The context that is current, if it is one of EGL.
std::optional<XrGraphicsBindingEGLMNDX> egl_binding() {
  const char* const library = "libEGL.so.1";
  const auto current = OPENED(library, eglGetCurrentContext);
  if (current == nullptr || current() == EGL_NO_CONTEXT) return std::nullopt;
  XrGraphicsBindingEGLMNDX binding{XR_TYPE_GRAPHICS_BINDING_EGL_MNDX};
  binding.getProcAddress = opened<PFNEGLGETPROCADDRESSPROC>(library, "eglGetProcAddress");
  binding.display = OPENED(library, eglGetCurrentDisplay)();
  binding.context = current();
  EGLint id = 0, count = 0;  // of the config: 0 for a context that was made without one
  OPENED(library, eglQueryContext)(binding.display, binding.context, EGL_CONFIG_ID, &id);
  const EGLint wanted[] = {EGL_CONFIG_ID, id, EGL_NONE};
  if (id != 0) OPENED(library, eglChooseConfig)(binding.display, wanted, &binding.config, 1, &count);
  return binding;
}

// The same of GLX.
std::optional<XrGraphicsBindingOpenGLXlibKHR> glx_binding() {
  const char* const library = "libGLX.so.0";
  const auto current = OPENED(library, glXGetCurrentContext);
  if (current == nullptr || current() == nullptr) return std::nullopt;
  XrGraphicsBindingOpenGLXlibKHR binding{XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR};
  binding.xDisplay = OPENED(library, glXGetCurrentDisplay)();
  binding.glxContext = current();
  binding.glxDrawable = OPENED(library, glXGetCurrentDrawable)();
  const auto query = OPENED(library, glXQueryContext);
  int id = 0, screen = 0, count = 0;
  query(binding.xDisplay, binding.glxContext, GLX_FBCONFIG_ID, &id);
  query(binding.xDisplay, binding.glxContext, GLX_SCREEN, &screen);
  const int wanted[] = {GLX_FBCONFIG_ID, id, 0};
  GLXFBConfig* const configs = OPENED(library, glXChooseFBConfig)(binding.xDisplay, screen, wanted, &count);
  if (configs == nullptr) return binding;
  binding.glxFBConfig = configs[0];
  const auto release = OPENED("libX11.so.6", XFree);
  XVisualInfo* const visual = OPENED(library, glXGetVisualFromFBConfig)(binding.xDisplay, configs[0]);
  if (visual != nullptr) {
    binding.visualid = static_cast<std::uint32_t>(visual->visualid);
    release(visual);
  }
  release(configs);
  return binding;
}

// A session needs this call before it, whatever it says: newer contexts are what drivers give anyway.
void ask_for_requirements(const Instance& instance) {
  PFN_xrGetOpenGLGraphicsRequirementsKHR get = nullptr;
  XR(GetInstanceProcAddr, instance.handle.get(), "xrGetOpenGLGraphicsRequirementsKHR",
     reinterpret_cast<PFN_xrVoidFunction*>(&get));
  XrGraphicsRequirementsOpenGLKHR range{XR_TYPE_GRAPHICS_REQUIREMENTS_OPENGL_KHR};
  check(get(instance.handle.get(), instance.system, &range), "xrGetOpenGLGraphicsRequirementsKHR");
}

}  // namespace

GetProcAddress get_proc_address() {
  if (const auto egl = egl_binding()) return egl->getProcAddress;
  if (!glx_binding()) refuse("OpenXR takes contexts of EGL and of GLX only, and none is current");
  return reinterpret_cast<GetProcAddress>(OPENED("libGLX.so.0", glXGetProcAddressARB));
}

Session::Session(const Instance& instance) : instance_(instance) {
  ask_for_requirements(instance);
  const auto egl = egl_binding();
  if (egl && !instance.has(egl_extension)) {
    refuse(
        "{} takes no EGL contexts ({} is missing): run this where there is an X display, without "
        "--no-mirror: then the window's own context of GLX draws",
        instance.runtime, egl_extension);
  }
  const auto glx = egl ? std::nullopt : glx_binding();
  const void* const binding = egl ? static_cast<const void*>(&*egl) : &*glx;
  const XrSessionCreateInfo info{XR_TYPE_SESSION_CREATE_INFO, binding, 0, instance.system};
  XrSession made = XR_NULL_HANDLE;
  const XrResult result = XR_CALL(CreateSession, instance.handle.get(), &info, &made);
  if (result == XR_ERROR_GRAPHICS_DEVICE_INVALID) {
    refuse(
        "{} does not take this OpenGL context ({}): some runtimes want the GPU that the headset is connected "
        "to (--device), SteamVR on Linux may take none at all",
        instance.runtime, name_of(result));
  }
  check(result, "xrCreateSession");
  session_ = Owned<XrSession>(made, {"xrDestroySession"});
  make_space();
}

void Session::make_space() {
  const auto spaces = all_of<XrReferenceSpaceType>({}, [&](auto room, auto* count, auto* all) {
    XR(EnumerateReferenceSpaces, handle(), room, count, all);
  });
  XrReferenceSpaceCreateInfo info{XR_TYPE_REFERENCE_SPACE_CREATE_INFO, nullptr, XR_REFERENCE_SPACE_TYPE_LOCAL,
                                  no_move};  // every runtime has it
  for (const XrReferenceSpaceType type : {local_floor, XR_REFERENCE_SPACE_TYPE_STAGE}) {
    on_floor_ = std::find(spaces.begin(), spaces.end(), type) != spaces.end();
    if (!on_floor_) continue;
    info.referenceSpaceType = type;
    on_stage_ = type == XR_REFERENCE_SPACE_TYPE_STAGE;
    break;
  }
  XrSpace made = XR_NULL_HANDLE;
  XR(CreateReferenceSpace, handle(), &info, &made);
  space_ = Owned<XrSpace>(made, {"xrDestroySpace"});
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

FrameTime Session::begin_frame() {
  XrFrameState state{XR_TYPE_FRAME_STATE};
  XR(WaitFrame, handle(), nullptr, &state);
  XR(BeginFrame, handle(), nullptr);
  return {state.predictedDisplayTime, state.predictedDisplayPeriod, state.shouldRender == XR_TRUE};
}

std::vector<XrView> Session::locate(XrTime display) const {
  const XrViewLocateInfo info{XR_TYPE_VIEW_LOCATE_INFO, nullptr, instance_.views, display, space()};
  XrViewState state{XR_TYPE_VIEW_STATE};
  std::vector<XrView> views = all_of(XrView{XR_TYPE_VIEW}, [&](auto room, auto* count, auto* all) {
    XR(LocateViews, handle(), &info, &state, room, count, all);
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

void Session::end_frame(const FrameTime& frame, const XrCompositionLayerBaseHeader* layer) {
  const XrFrameEndInfo info{
      XR_TYPE_FRAME_END_INFO,     nullptr, frame.display, XR_ENVIRONMENT_BLEND_MODE_OPAQUE,
      layer == nullptr ? 0u : 1u, &layer};
  XR(EndFrame, handle(), &info);
}

}  // namespace binosplat::xr
