// A program with an OpenXR session of its own that has binosplat draw both eyes: openxr MODEL.ply shows the
// model in the headset until the runtime says that it is over.
#define GL_GLEXT_PROTOTYPES
#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_PLATFORM_EGL
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

#include <binosplat/renderer.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

XrInstance instance = XR_NULL_HANDLE;

// Every call of OpenXR goes through this one: a negative result is an error.
XrResult check(const char* call, XrResult result) {
  if (result >= 0) return result;
  char name[XR_MAX_RESULT_STRING_SIZE] = "no instance";
  if (instance != XR_NULL_HANDLE) xrResultToString(instance, result, name);
  throw std::runtime_error(std::string(call) + " failed: " + name + " (" + std::to_string(result) + ")");
}
#define XR(call, ...) check(#call, call(__VA_ARGS__))

// The images of one eye, which take turns.
struct Swapchain {
  XrSwapchain handle = XR_NULL_HANDLE;
  glm::ivec2 size{0};
  std::vector<XrSwapchainImageOpenGLKHR> images;
  bool in_place = true;
};
constexpr XrViewConfigurationType stereo_views = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
void make_instance() {
  const char* const extensions[] = {"XR_MNDX_egl_enable", "XR_KHR_opengl_enable"};
  XrInstanceCreateInfo info = {XR_TYPE_INSTANCE_CREATE_INFO};
  info.applicationInfo = {"binosplat's example", 1, "binosplat", 1, XR_MAKE_VERSION(1, 0, 0)};
  info.enabledExtensionCount = 2;
  info.enabledExtensionNames = extensions;
  XR(xrCreateInstance, &info, &instance);
}

// An OpenGL 4.5 core context without a window, current, and a session that takes its pictures.
XrSession make_session(XrSystemId system) {
  const EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5, EGL_NONE};
  eglInitialize(display, nullptr, nullptr);
  eglBindAPI(EGL_OPENGL_API);
  const EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
  if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_FALSE)
    throw std::runtime_error("no context of OpenGL 4.5 core");
  // OpenXR asks for this call before a session, whatever it answers.
  PFN_xrGetOpenGLGraphicsRequirementsKHR get_requirements = nullptr;
  XR(xrGetInstanceProcAddr, instance, "xrGetOpenGLGraphicsRequirementsKHR",
     reinterpret_cast<PFN_xrVoidFunction*>(&get_requirements));
  XrGraphicsRequirementsOpenGLKHR requirements = {XR_TYPE_GRAPHICS_REQUIREMENTS_OPENGL_KHR};
  XR(get_requirements, instance, system, &requirements);
  const XrGraphicsBindingEGLMNDX binding = {
      XR_TYPE_GRAPHICS_BINDING_EGL_MNDX, nullptr, eglGetProcAddress, display, EGL_NO_CONFIG_KHR, context};
  const XrSessionCreateInfo info = {XR_TYPE_SESSION_CREATE_INFO, &binding, 0, system};
  XrSession session = XR_NULL_HANDLE;
  XR(xrCreateSession, instance, &info, &session);
  return session;
}

Swapchain make_swapchain(XrSession session, const XrViewConfigurationView& view) {
  XrSwapchainCreateInfo info = {XR_TYPE_SWAPCHAIN_CREATE_INFO};
  // binosplat writes into the texture itself, by a view of another format, if the runtime lets it.
  info.usageFlags = XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT | XR_SWAPCHAIN_USAGE_UNORDERED_ACCESS_BIT |
                    XR_SWAPCHAIN_USAGE_MUTABLE_FORMAT_BIT;
  info.format = GL_SRGB8_ALPHA8;  // what models' colours are; a runtime without it says so
  info.width = view.recommendedImageRectWidth;
  info.height = view.recommendedImageRectHeight;
  info.sampleCount = info.faceCount = info.arraySize = info.mipCount = 1;
  Swapchain swapchain = {.size = {info.width, info.height}};
  if (xrCreateSwapchain(session, &info, &swapchain.handle) < 0) {  // as Monado: then through a copy
    swapchain.in_place = false;
    info.usageFlags = XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT;
    XR(xrCreateSwapchain, session, &info, &swapchain.handle);
  }
  std::uint32_t count = 0;
  XR(xrEnumerateSwapchainImages, swapchain.handle, 0, &count, nullptr);
  swapchain.images.resize(count, {XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_KHR});
  XR(xrEnumerateSwapchainImages, swapchain.handle, count, &count,
     reinterpret_cast<XrSwapchainImageBaseHeader*>(swapchain.images.data()));
  return swapchain;
}

// What the runtime has to say since the last frame. False: it is over.
bool handle_events(XrSession session, bool& running) {
  XrEventDataBuffer event = {XR_TYPE_EVENT_DATA_BUFFER};
  while (XR(xrPollEvent, instance, &event) == XR_SUCCESS) {
    if (event.type == XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING) return false;
    if (event.type == XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED) {
      const XrSessionState state = reinterpret_cast<const XrEventDataSessionStateChanged&>(event).state;
      if (state == XR_SESSION_STATE_READY) {
        const XrSessionBeginInfo info = {XR_TYPE_SESSION_BEGIN_INFO, nullptr, stereo_views};
        XR(xrBeginSession, session, &info);
        running = true;
      } else if (state == XR_SESSION_STATE_STOPPING) {
        XR(xrEndSession, session);
        running = false;
      } else if (state == XR_SESSION_STATE_EXITING || state == XR_SESSION_STATE_LOSS_PENDING) {
        return false;
      }
    }
    event = {XR_TYPE_EVENT_DATA_BUFFER};
  }
  return true;
}

// Draws what the eyes will see at `time`; `submitted` is what was drawn, pose and fov as they were given.
// False where the runtime does not know the eyes' poses.
bool draw(XrSession session, XrSpace space, XrTime time, binosplat::Renderer& renderer,
          const binosplat::Placement& placement, const std::array<Swapchain, 2>& swapchains,
          std::array<XrCompositionLayerProjectionView, 2>& submitted) {
  const XrViewLocateInfo info = {XR_TYPE_VIEW_LOCATE_INFO, nullptr, stereo_views, time, space};
  XrViewState state = {XR_TYPE_VIEW_STATE};
  std::array<XrView, 2> views;
  views.fill({XR_TYPE_VIEW});
  std::uint32_t count = 0;
  XR(xrLocateViews, session, &info, &state, 2, &count, views.data());
  constexpr XrViewStateFlags valid = XR_VIEW_STATE_ORIENTATION_VALID_BIT | XR_VIEW_STATE_POSITION_VALID_BIT;
  if ((state.viewStateFlags & valid) != valid) return false;
  std::array<binosplat::View, 2> pictures;
  for (std::size_t k = 0; k < 2; ++k) {
    const XrVector3f& p = views[k].pose.position;
    const XrQuaternionf& q = views[k].pose.orientation;
    const XrFovf& fov = views[k].fov;
    const auto& [swapchain, size, images, in_place] = swapchains[k];
    std::uint32_t image = 0;
    XR(xrAcquireSwapchainImage, swapchain, nullptr, &image);
    const XrSwapchainImageWaitInfo wait = {XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO, nullptr, XR_INFINITE_DURATION};
    XR(xrWaitSwapchainImage, swapchain, &wait);
    const binosplat::Eye eye = {
        {p.x, p.y, p.z}, {q.x, q.y, q.z, q.w}, {fov.angleLeft, fov.angleRight, fov.angleUp, fov.angleDown}};
    pictures[k] = {eye, size, {.texture = images[image].image, .in_place = in_place}};
    const XrSwapchainSubImage whole = {swapchain, {{0, 0}, {size.x, size.y}}, 0};
    submitted[k] = {XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW, nullptr, views[k].pose, fov, whole};
  }
  renderer.draw(pictures, placement, {.background = glm::vec3(0.0f)});
  for (const Swapchain& swapchain : swapchains) XR(xrReleaseSwapchainImage, swapchain.handle, nullptr);
  return true;
}

int main(int argc, char** argv) try {
  if (argc != 2) return std::fprintf(stderr, "usage: openxr MODEL.ply\n"), 2;
  const binosplat::SplatModel model(argv[1]);
  make_instance();
  const XrSystemGetInfo headset = {XR_TYPE_SYSTEM_GET_INFO, nullptr, XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY};
  XrSystemId system = XR_NULL_SYSTEM_ID;
  XR(xrGetSystem, instance, &headset, &system);
  std::array<XrViewConfigurationView, 2> sizes;
  sizes.fill({XR_TYPE_VIEW_CONFIGURATION_VIEW});
  std::uint32_t count = 0;
  XR(xrEnumerateViewConfigurationViews, instance, system, stereo_views, 2, &count, sizes.data());
  const XrSession session = make_session(system);
  const std::array swapchains = {make_swapchain(session, sizes[0]), make_swapchain(session, sizes[1])};
  // LOCAL begins where the head is at the start, which here is the origin of the model's world.
  XrReferenceSpaceCreateInfo where = {XR_TYPE_REFERENCE_SPACE_CREATE_INFO};
  where.referenceSpaceType = XR_REFERENCE_SPACE_TYPE_LOCAL;
  where.poseInReferenceSpace.orientation.w = 1.0f;
  XrSpace space = XR_NULL_HANDLE;
  XR(xrCreateReferenceSpace, session, &where, &space);
  const binosplat::Placement placement = model.placement();
  binosplat::Renderer renderer(eglGetProcAddress, model);
  bool running = false;
  while (handle_events(session, running)) {
    if (!running) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      continue;
    }
    XrFrameState frame = {XR_TYPE_FRAME_STATE};
    XR(xrWaitFrame, session, nullptr, &frame);
    XR(xrBeginFrame, session, nullptr);
    std::array<XrCompositionLayerProjectionView, 2> views{};
    const bool drawn = frame.shouldRender == XR_TRUE && draw(session, space, frame.predictedDisplayTime,
                                                             renderer, placement, swapchains, views);
    const XrCompositionLayerProjection layer = {
        XR_TYPE_COMPOSITION_LAYER_PROJECTION, nullptr, 0, space, 2, views.data()};
    const auto* layers = reinterpret_cast<const XrCompositionLayerBaseHeader*>(&layer);
    const XrFrameEndInfo end = {XR_TYPE_FRAME_END_INFO,           nullptr,         frame.predictedDisplayTime,
                                XR_ENVIRONMENT_BLEND_MODE_OPAQUE, drawn ? 1u : 0u, &layers};
    XR(xrEndFrame, session, &end);
  }
  XR(xrDestroySpace, space);
  for (const Swapchain& swapchain : swapchains) XR(xrDestroySwapchain, swapchain.handle);
  XR(xrDestroySession, session);
  XR(xrDestroyInstance, instance);
} catch (const std::exception& error) {
  std::fprintf(stderr, "openxr: %s\n", error.what());
  return 2;
}
