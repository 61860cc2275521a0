// A program with its own OpenXR session. It draws the controllers as boxes, and binosplat draws a model's
// splats among them. openxr MODEL.ply runs until the runtime ends the session.
#define GL_GLEXT_PROTOTYPES
#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_PLATFORM_EGL
#define XR_USE_PLATFORM_XLIB
#include <binosplat/renderer.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>
// The headers of X have macros that collide with many names, so they come last.
#include <GL/glx.h>
#include <X11/Xlib.h>
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

XrInstance instance = XR_NULL_HANDLE;

// Checks every OpenXR call: a negative result is an error.
XrResult check(const char* call, XrResult result) {
  if (result >= 0) return result;
  char name[XR_MAX_RESULT_STRING_SIZE] = "no instance";
  if (instance != XR_NULL_HANDLE) xrResultToString(instance, result, name);
  throw std::runtime_error(std::string(call) + " failed: " + name + " (" + std::to_string(result) + ")");
}
#define XR(call, ...) check(#call, call(__VA_ARGS__))

// The images of one eye, and the objects with which OpenGL draws boxes into them.
struct Swapchain {
  XrSwapchain handle = XR_NULL_HANDLE;
  glm::ivec2 size{0};
  std::vector<XrSwapchainImageOpenGLKHR> images;
  bool in_place = true;
  GLuint depths = 0, framebuffer = 0;
};
// The actions that locate the controllers.
struct Hands {
  XrActionSet set = XR_NULL_HANDLE;
  std::array<XrSpace, 2> grips = {};
};
constexpr XrViewConfigurationType stereo_views = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
// Returns whether the runtime takes OpenGL contexts of EGL, as Monado does, which needs no X display. Other
// runtimes, such as SteamVR, take contexts of GLX.
bool make_instance() {
  setenv("XR_LOADER_DEBUG", "none", 0);  // the error below replaces the loader's messages
  std::uint32_t count = 0;
  if (xrEnumerateInstanceExtensionProperties(nullptr, 0, &count, nullptr) < 0)
    throw std::runtime_error(
        "no OpenXR runtime. Install one for the headset, such as Monado or SteamVR, start it, and make it "
        "the active one (~/.config/openxr/1/active_runtime.json, or the variable XR_RUNTIME_JSON)");
  std::vector<XrExtensionProperties> offered(count, {XR_TYPE_EXTENSION_PROPERTIES});
  XR(xrEnumerateInstanceExtensionProperties, nullptr, count, &count, offered.data());
  bool takes_egl = false;
  for (const XrExtensionProperties& one : offered)
    takes_egl = takes_egl || std::strcmp(one.extensionName, "XR_MNDX_egl_enable") == 0;
  const char* const extensions[] = {"XR_KHR_opengl_enable", "XR_MNDX_egl_enable"};
  XrInstanceCreateInfo info = {XR_TYPE_INSTANCE_CREATE_INFO};
  info.applicationInfo = {"binosplat's example", 1, "binosplat", 1, XR_MAKE_VERSION(1, 0, 0)};
  info.enabledExtensionCount = takes_egl ? 2 : 1;
  info.enabledExtensionNames = extensions;
  XR(xrCreateInstance, &info, &instance);
  return takes_egl;
}

// Creates and makes current an OpenGL 4.5 core context without a window.
XrGraphicsBindingEGLMNDX make_egl_context() {
  const EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5, EGL_NONE};
  eglInitialize(display, nullptr, nullptr);
  eglBindAPI(EGL_OPENGL_API);
  const EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
  if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_FALSE)
    throw std::runtime_error("no context of OpenGL 4.5 core");
  return {XR_TYPE_GRAPHICS_BINDING_EGL_MNDX, nullptr, eglGetProcAddress, display, EGL_NO_CONFIG_KHR, context};
}

// The same by GLX, which draws into something of an X display: here a buffer of one pixel.
XrGraphicsBindingOpenGLXlibKHR make_glx_context() {
  Display* const display = XOpenDisplay(nullptr);
  if (display == nullptr)
    throw std::runtime_error(
        "the runtime takes OpenGL contexts of GLX only, which need an X display (DISPLAY)");
  const int wanted[] = {GLX_DRAWABLE_TYPE, GLX_PBUFFER_BIT, None};
  int count = 0;
  GLXFBConfig* const configs = glXChooseFBConfig(display, DefaultScreen(display), wanted, &count);
  const auto create = reinterpret_cast<PFNGLXCREATECONTEXTATTRIBSARBPROC>(
      glXGetProcAddress(reinterpret_cast<const GLubyte*>("glXCreateContextAttribsARB")));
  const int size[] = {GLX_PBUFFER_WIDTH, 1, GLX_PBUFFER_HEIGHT, 1, None};
  const int version[] = {
      GLX_CONTEXT_MAJOR_VERSION_ARB,    4,   GLX_CONTEXT_MINOR_VERSION_ARB, 5, GLX_CONTEXT_PROFILE_MASK_ARB,
      GLX_CONTEXT_CORE_PROFILE_BIT_ARB, None};
  const GLXContext context =
      count > 0 && create != nullptr ? create(display, configs[0], nullptr, True, version) : nullptr;
  if (context == nullptr) throw std::runtime_error("no context of OpenGL 4.5 core on the X display");
  const GLXPbuffer buffer = glXCreatePbuffer(display, configs[0], size);
  glXMakeContextCurrent(display, buffer, buffer, context);
  // Runtimes ignore the visual and the config.
  return {XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR, nullptr, display, 0, configs[0], buffer, context};
}

XrSession make_session(XrSystemId system, bool takes_egl) {
  XrGraphicsBindingEGLMNDX egl = {};
  XrGraphicsBindingOpenGLXlibKHR glx = {};
  if (takes_egl)
    egl = make_egl_context();
  else
    glx = make_glx_context();
  // OpenXR requires this call before a session. Its result is unused.
  PFN_xrGetOpenGLGraphicsRequirementsKHR get_requirements = nullptr;
  XR(xrGetInstanceProcAddr, instance, "xrGetOpenGLGraphicsRequirementsKHR",
     reinterpret_cast<PFN_xrVoidFunction*>(&get_requirements));
  XrGraphicsRequirementsOpenGLKHR requirements = {XR_TYPE_GRAPHICS_REQUIREMENTS_OPENGL_KHR};
  XR(get_requirements, instance, system, &requirements);
  const void* const binding = takes_egl ? static_cast<const void*>(&egl) : &glx;
  const XrSessionCreateInfo info = {XR_TYPE_SESSION_CREATE_INFO, binding, 0, system};
  XrSession session = XR_NULL_HANDLE;
  XR(xrCreateSession, instance, &info, &session);
  return session;
}

Swapchain make_swapchain(XrSession session, const XrViewConfigurationView& view) {
  XrSwapchainCreateInfo info = {XR_TYPE_SWAPCHAIN_CREATE_INFO};
  // If the runtime allows it, binosplat writes directly into the texture, through a view of another format.
  info.usageFlags = XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT | XR_SWAPCHAIN_USAGE_UNORDERED_ACCESS_BIT |
                    XR_SWAPCHAIN_USAGE_MUTABLE_FORMAT_BIT;
  info.format = GL_SRGB8_ALPHA8;  // the colour space of models; a runtime without it reports an error
  info.width = view.recommendedImageRectWidth;
  info.height = view.recommendedImageRectHeight;
  info.sampleCount = info.faceCount = info.arraySize = info.mipCount = 1;
  Swapchain swapchain = {.size = {info.width, info.height}};
  if (xrCreateSwapchain(session, &info, &swapchain.handle) < 0) {  // Monado refuses: copy instead
    swapchain.in_place = false;
    info.usageFlags = XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT;
    XR(xrCreateSwapchain, session, &info, &swapchain.handle);
  }
  std::uint32_t count = 0;
  XR(xrEnumerateSwapchainImages, swapchain.handle, 0, &count, nullptr);
  swapchain.images.resize(count, {XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_KHR});
  XR(xrEnumerateSwapchainImages, swapchain.handle, count, &count,
     reinterpret_cast<XrSwapchainImageBaseHeader*>(swapchain.images.data()));
  glCreateTextures(GL_TEXTURE_2D, 1, &swapchain.depths);
  glTextureStorage2D(swapchain.depths, 1, GL_DEPTH_COMPONENT32F, swapchain.size.x, swapchain.size.y);
  glCreateFramebuffers(1, &swapchain.framebuffer);
  glNamedFramebufferTexture(swapchain.framebuffer, GL_DEPTH_ATTACHMENT, swapchain.depths, 0);
  return swapchain;
}

XrPath path(const std::string& text) {
  XrPath out = XR_NULL_PATH;
  XR(xrStringToPath, instance, text.c_str(), &out);
  return out;
}

// One action for the grips of both hands. Runtimes also map the simple controller's profile to other
// controllers.
Hands make_hands(XrSession session) {
  const std::array<std::string, 2> names = {"/user/hand/left", "/user/hand/right"};
  const std::array<XrPath, 2> paths = {path(names[0]), path(names[1])};
  Hands hands;
  const XrActionSetCreateInfo set = {XR_TYPE_ACTION_SET_CREATE_INFO, nullptr, "hands", "Hands", 0};
  XR(xrCreateActionSet, instance, &set, &hands.set);
  const XrActionCreateInfo info = {
      XR_TYPE_ACTION_CREATE_INFO, nullptr, "grip", XR_ACTION_TYPE_POSE_INPUT, 2, paths.data(), "Grip"};
  XrAction grip = XR_NULL_HANDLE;
  XR(xrCreateAction, hands.set, &info, &grip);
  const std::array<XrActionSuggestedBinding, 2> bindings = {
      {{grip, path(names[0] + "/input/grip/pose")}, {grip, path(names[1] + "/input/grip/pose")}}};
  const XrInteractionProfileSuggestedBinding suggested = {
      XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING, nullptr,
      path("/interaction_profiles/khr/simple_controller"), 2, bindings.data()};
  XR(xrSuggestInteractionProfileBindings, instance, &suggested);
  const XrSessionActionSetsAttachInfo attach = {XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO, nullptr, 1,
                                                &hands.set};
  XR(xrAttachSessionActionSets, session, &attach);
  for (std::size_t k = 0; k < 2; ++k) {
    const XrActionSpaceCreateInfo at = {
        XR_TYPE_ACTION_SPACE_CREATE_INFO, nullptr, grip, paths[k], {{0, 0, 0, 1}, {0, 0, 0}}};
    XR(xrCreateActionSpace, session, &at, &hands.grips[k]);
  }
  return hands;
}

glm::dmat4 matrix(const glm::dvec3& position, const glm::dvec4& q) {
  return glm::translate(glm::dmat4(1), position) * glm::mat4_cast(glm::dquat(q.w, q.x, q.y, q.z));
}

// The boxes of the tracked hands, 4 x 4 x 12 cm each, in `space`.
std::vector<glm::dmat4> locate_boxes(XrSession session, const Hands& hands, XrSpace space, XrTime time) {
  const XrActiveActionSet active = {hands.set, XR_NULL_PATH};
  const XrActionsSyncInfo info = {XR_TYPE_ACTIONS_SYNC_INFO, nullptr, 1, &active};
  XR(xrSyncActions, session, &info);  // finds no controllers without focus
  constexpr XrSpaceLocationFlags valid =
      XR_SPACE_LOCATION_ORIENTATION_VALID_BIT | XR_SPACE_LOCATION_POSITION_VALID_BIT;
  std::vector<glm::dmat4> boxes;
  for (const XrSpace grip : hands.grips) {
    XrSpaceLocation at = {XR_TYPE_SPACE_LOCATION};
    XR(xrLocateSpace, grip, space, time, &at);
    const auto& [q, p] = at.pose;
    if ((at.locationFlags & valid) == valid)
      boxes.push_back(glm::scale(matrix({p.x, p.y, p.z}, {q.x, q.y, q.z, q.w}), {0.04, 0.04, 0.12}));
  }
  return boxes;
}

// Draws scaled unit boxes. Their colours are linear; GL_FRAMEBUFFER_SRGB converts them to the sRGB values of
// the texture, in which binosplat blends.
void set_up_drawing() {
  const char* const sources[] = {R"(#version 450 core
layout(location = 0) uniform mat4 clip_from_box;
const vec2 corners[] = {{-1, -1}, {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}};
out vec3 light;
void main() {
  int axis = gl_VertexID / 12;
  vec3 corner = vec3(gl_VertexID % 12 < 6 ? 0.5 : -0.5);
  corner[(axis + 1) % 3] = 0.5 * corners[gl_VertexID % 6].x;
  corner[(axis + 2) % 3] = 0.5 * corners[gl_VertexID % 6].y;
  light = vec3(0.9, 0.25, 0.03) * vec3(0.7, 1.0, 0.3)[axis];
  gl_Position = clip_from_box * vec4(corner, 1);
})",
                                 R"(#version 450 core
in vec3 light; out vec4 fragment;
void main() { fragment = vec4(light, 1); })"};
  const GLuint program = glCreateProgram();
  for (int k = 0; k < 2; ++k) {
    const GLuint shader = glCreateShader(k == 0 ? GL_VERTEX_SHADER : GL_FRAGMENT_SHADER);
    glShaderSource(shader, 1, &sources[k], nullptr);
    glCompileShader(shader);
    glAttachShader(program, shader);
  }
  glLinkProgram(program);
  GLuint vertices = 0;
  glCreateVertexArrays(1, &vertices);
  glUseProgram(program);  // set once: binosplat preserves all state
  glBindVertexArray(vertices);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_FRAMEBUFFER_SRGB);
  glClearColor(0, 0, 0, 1);
}

// Clears an eye's image and draws the boxes into it. Returns their depths for binosplat.
binosplat::MeshDepth draw_boxes(const Swapchain& swapchain, GLuint image, const binosplat::Eye& eye,
                                double units_per_metre, const std::vector<glm::dmat4>& boxes) {
  glNamedFramebufferTexture(swapchain.framebuffer, GL_COLOR_ATTACHMENT0, image, 0);
  glBindFramebuffer(GL_FRAMEBUFFER, swapchain.framebuffer);
  glViewport(0, 0, swapchain.size.x, swapchain.size.y);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  constexpr double near = 0.05, far = 100.0;  // m
  const auto [left, right, up, down] = eye.fov;
  const glm::dvec4 side = near * glm::tan(glm::dvec4(left, right, down, up));
  const glm::dmat4 clip = glm::frustum(side.x, side.y, side.z, side.w, near, far) *
                          glm::inverse(matrix(eye.position, eye.orientation));
  for (const glm::dmat4& box : boxes) {
    const glm::mat4 clip_from_box = clip * box;
    glUniformMatrix4fv(0, 1, GL_FALSE, &clip_from_box[0].x);
    glDrawArrays(GL_TRIANGLES, 0, 36);
  }
  return {
      .texture = swapchain.depths, .near_plane = near * units_per_metre, .far_plane = far * units_per_metre};
}

// Handles the runtime's events since the last frame. Returns false if the session is over.
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

// Everything that a frame needs.
struct Stage {
  XrSession session = XR_NULL_HANDLE;
  XrSpace space = XR_NULL_HANDLE;
  std::array<Swapchain, 2> swapchains;
  Hands hands;
  binosplat::Placement placement;
  binosplat::Renderer renderer;
};

// Draws the views at `time`. `submitted` receives the drawn images, with poses and angles unchanged. Returns
// false if the runtime does not know the eyes' poses.
bool draw(Stage& stage, XrTime time, std::array<XrCompositionLayerProjectionView, 2>& submitted) {
  const XrViewLocateInfo info = {XR_TYPE_VIEW_LOCATE_INFO, nullptr, stereo_views, time, stage.space};
  XrViewState state = {XR_TYPE_VIEW_STATE};
  std::array<XrView, 2> views;
  views.fill({XR_TYPE_VIEW});
  std::uint32_t count = 0;
  XR(xrLocateViews, stage.session, &info, &state, 2, &count, views.data());
  constexpr XrViewStateFlags valid = XR_VIEW_STATE_ORIENTATION_VALID_BIT | XR_VIEW_STATE_POSITION_VALID_BIT;
  if ((state.viewStateFlags & valid) != valid) return false;
  const std::vector<glm::dmat4> boxes = locate_boxes(stage.session, stage.hands, stage.space, time);
  std::array<binosplat::View, 2> pictures;
  for (std::size_t k = 0; k < 2; ++k) {
    const XrVector3f& p = views[k].pose.position;
    const XrQuaternionf& q = views[k].pose.orientation;
    const XrFovf& fov = views[k].fov;
    const Swapchain& swapchain = stage.swapchains[k];
    std::uint32_t image = 0;
    XR(xrAcquireSwapchainImage, swapchain.handle, nullptr, &image);
    const XrSwapchainImageWaitInfo wait = {XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO, nullptr, XR_INFINITE_DURATION};
    XR(xrWaitSwapchainImage, swapchain.handle, &wait);
    const binosplat::Eye eye = {
        {p.x, p.y, p.z}, {q.x, q.y, q.z, q.w}, {fov.angleLeft, fov.angleRight, fov.angleUp, fov.angleDown}};
    const GLuint texture = swapchain.images[image].image;
    pictures[k] = {eye, swapchain.size, {.texture = texture, .in_place = swapchain.in_place}};
    pictures[k].mesh_depth = draw_boxes(swapchain, texture, eye, stage.placement.units_per_metre, boxes);
    const XrSwapchainSubImage whole = {swapchain.handle, {{0, 0}, {swapchain.size.x, swapchain.size.y}}, 0};
    submitted[k] = {XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW, nullptr, views[k].pose, fov, whole};
  }
  stage.renderer.submit(pictures, stage.placement, binosplat::Settings::headset());
  // While the GPU draws here, the CPU is free for physics, sound and the next frame's meshes.
  stage.renderer.finish();  // binosplat uses the images until this returns
  for (const Swapchain& swapchain : stage.swapchains) XR(xrReleaseSwapchainImage, swapchain.handle, nullptr);
  return true;
}

int main(int argc, char** argv) try {
  if (argc != 2) return std::fprintf(stderr, "usage: openxr MODEL.ply\n"), 2;
  const binosplat::SplatModel model(argv[1]);
  const bool takes_egl = make_instance();
  const XrSystemGetInfo headset = {XR_TYPE_SYSTEM_GET_INFO, nullptr, XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY};
  XrSystemId system = XR_NULL_SYSTEM_ID;
  XR(xrGetSystem, instance, &headset, &system);
  std::array<XrViewConfigurationView, 2> sizes;
  sizes.fill({XR_TYPE_VIEW_CONFIGURATION_VIEW});
  std::uint32_t count = 0;
  XR(xrEnumerateViewConfigurationViews, instance, system, stereo_views, 2, &count, sizes.data());
  const XrSession session = make_session(system, takes_egl);
  // LOCAL has its origin at the head's first position, here placed at the origin of the model's world.
  XrReferenceSpaceCreateInfo where = {XR_TYPE_REFERENCE_SPACE_CREATE_INFO};
  where.referenceSpaceType = XR_REFERENCE_SPACE_TYPE_LOCAL;
  where.poseInReferenceSpace.orientation.w = 1.0f;
  XrSpace space = XR_NULL_HANDLE;
  XR(xrCreateReferenceSpace, session, &where, &space);
  const auto get_proc_address =
      takes_egl ? eglGetProcAddress : reinterpret_cast<binosplat::GetProcAddress>(glXGetProcAddress);
  Stage stage = {session,
                 space,
                 {make_swapchain(session, sizes[0]), make_swapchain(session, sizes[1])},
                 make_hands(session),
                 model.placement(),
                 binosplat::Renderer(get_proc_address, model)};
  set_up_drawing();
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
    const bool drawn = frame.shouldRender == XR_TRUE && draw(stage, frame.predictedDisplayTime, views);
    const XrCompositionLayerProjection layer = {
        XR_TYPE_COMPOSITION_LAYER_PROJECTION, nullptr, 0, space, 2, views.data()};
    const auto* layers = reinterpret_cast<const XrCompositionLayerBaseHeader*>(&layer);
    const XrFrameEndInfo end = {XR_TYPE_FRAME_END_INFO,           nullptr,         frame.predictedDisplayTime,
                                XR_ENVIRONMENT_BLEND_MODE_OPAQUE, drawn ? 1u : 0u, &layers};
    XR(xrEndFrame, session, &end);
  }
  for (const XrSpace each : {stage.hands.grips[0], stage.hands.grips[1], space}) XR(xrDestroySpace, each);
  for (const Swapchain& swapchain : stage.swapchains) XR(xrDestroySwapchain, swapchain.handle);
  XR(xrDestroyActionSet, stage.hands.set);
  XR(xrDestroySession, session);
  XR(xrDestroyInstance, instance);
} catch (const std::exception& error) {
  std::fprintf(stderr, "openxr: %s\n", error.what());
  return 2;
}
