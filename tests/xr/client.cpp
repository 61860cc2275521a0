// A small application of OpenXR that does all by the book, but for the faults that its arguments name: for
// the tests of the runtime. Says which calls failed and how. Words that are no faults: depth (hands in depth,
// too), quad (four views), actions (hands are read; gaze: eyes, too), mask, again (a
// second session after a lost one), sizes (what is recommended), depth24 (a
// format), stage or floor (the space of the layer).
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <set>
#include <string>
#include <vector>

#include "xr/client_actions.h"
#include "xr/client_images.h"

namespace binosplat::xr_test {
namespace {

constexpr XrPosef origin = {{0, 0, 0, 1}, {0, 0, 0}};

struct Client {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  XrSystemId system = XR_NULL_SYSTEM_ID;
  XrViewConfigurationType type =
      has("quad") ? XR_VIEW_CONFIGURATION_TYPE_PRIMARY_QUAD_VARJO : XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
  std::vector<XrViewConfigurationView> sizes;
  XrSession session = XR_NULL_HANDLE;
  XrSpace space = XR_NULL_HANDLE, other_space = XR_NULL_HANDLE;
  std::vector<Chain> colours, depths;
  XrSessionState state = XR_SESSION_STATE_UNKNOWN;
  bool running = false, over = false;
  int frame = 0;
  std::vector<XrView> last_views;
  Actions actions;

  bool at(const char* word) const { return frame == 1 && has(word); }

  void make_context() {
    display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5, EGL_NONE};
    eglInitialize(display, nullptr, nullptr);
    eglBindAPI(EGL_OPENGL_API);
    context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context);
  }

  bool make_instance() {
    std::vector<const char*> extensions = {XR_KHR_OPENGL_ENABLE_EXTENSION_NAME,
                                           XR_MNDX_EGL_ENABLE_EXTENSION_NAME};
    if (has("binding_unasked")) extensions.pop_back();
    if (!has("depth_unasked")) extensions.push_back(XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME);
    if (has("quad")) extensions.push_back(XR_VARJO_QUAD_VIEWS_EXTENSION_NAME);
    if (has("gaze")) extensions.push_back(XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME);
    if (has("floor") && !has("floor_unasked")) extensions.push_back(XR_LOCAL_FLOOR_NAME);
    if (has("mask")) extensions.push_back(XR_KHR_VISIBILITY_MASK_EXTENSION_NAME);
    XrInstanceCreateInfo info = {XR_TYPE_INSTANCE_CREATE_INFO};
    info.applicationInfo = {"client", 1, "", 0, XR_MAKE_VERSION(1, 0, 0)};
    if (has("no_name")) info.applicationInfo.applicationName[0] = '\0';
    info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
    info.enabledExtensionNames = extensions.data();
    return XR(xrCreateInstance, &info, &instance) == XR_SUCCESS;
  }

  bool find_system() {
    XrSystemGetInfo info = {has("wrong_type") ? XR_TYPE_VIEW : XR_TYPE_SYSTEM_GET_INFO};
    info.formFactor =
        has("form_factor") ? XR_FORM_FACTOR_HANDHELD_DISPLAY : XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY;
    if (XR(xrGetSystem, instance, &info, &system) != XR_SUCCESS) return false;
    if (has("bad_path")) {
      XrPath path = 0;
      XR(xrStringToPath, instance, "no/slash", &path);
    }
    std::uint32_t count = 0;
    const auto mono = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_MONO;
    XR(xrEnumerateViewConfigurationViews, instance, has("bad_system") ? 1 : system,
       has("bad_configuration") ? mono : type, 0, &count, nullptr);
    sizes.assign(count, {has("view_type") ? XR_TYPE_VIEW : XR_TYPE_VIEW_CONFIGURATION_VIEW});
    XR(xrEnumerateViewConfigurationViews, instance, system, type, has("small_array") ? 1 : count, &count,
       sizes.data());
    return sizes.size() == (has("quad") ? 4 : 2);
  }

  bool make_session() {
    PFN_xrGetOpenGLGraphicsRequirementsKHR get_requirements = nullptr;
    XR(xrGetInstanceProcAddr, instance, "xrGetOpenGLGraphicsRequirementsKHR",
       reinterpret_cast<PFN_xrVoidFunction*>(&get_requirements));
    XrGraphicsRequirementsOpenGLKHR requirements = {XR_TYPE_GRAPHICS_REQUIREMENTS_OPENGL_KHR};
    if (!has("no_requirements")) say("requirements", get_requirements(instance, system, &requirements));
    const XrGraphicsBindingEGLMNDX binding = {
        XR_TYPE_GRAPHICS_BINDING_EGL_MNDX, nullptr, eglGetProcAddress, display, nullptr, context};
    XrSessionCreateInfo info = {XR_TYPE_SESSION_CREATE_INFO, &binding, 0, system};
    if (has("no_binding")) info.next = nullptr;
    if (XR(xrCreateSession, instance, &info, &session) != XR_SUCCESS) return false;
    XrSession second = XR_NULL_HANDLE;
    if (has("second_session")) XR(xrCreateSession, instance, &info, &second);
    if (has("request_exit_early")) XR(xrRequestExitSession, session);
    if (has("frame_before_begin")) {
      XrFrameState frame_state = {XR_TYPE_FRAME_STATE};
      XR(xrWaitFrame, session, nullptr, &frame_state);
    }
    XrReferenceSpaceCreateInfo where = {XR_TYPE_REFERENCE_SPACE_CREATE_INFO};
    where.poseInReferenceSpace = origin;
    where.referenceSpaceType = has("unknown_space") ? XR_REFERENCE_SPACE_TYPE_UNBOUNDED_MSFT
                               : has("stage")       ? XR_REFERENCE_SPACE_TYPE_STAGE
                               : has("floor")       ? XR_REFERENCE_SPACE_TYPE_LOCAL_FLOOR_TEST
                                                    : XR_REFERENCE_SPACE_TYPE_LOCAL;
    if (has("bad_space")) where.poseInReferenceSpace.orientation.w = 2;
    if (XR(xrCreateReferenceSpace, session, &where, &space) != XR_SUCCESS) return false;
    return XR(xrCreateReferenceSpace, session, &where, &other_space) == XR_SUCCESS;
  }

  bool make_chain(Chain& chain, const XrViewConfigurationView& size, bool depth) const {
    XrSwapchainCreateInfo info = {XR_TYPE_SWAPCHAIN_CREATE_INFO};
    info.usageFlags = depth != has("wrong_usage") ? XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
                                                  : XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT;
    info.format = has("unknown_format") ? GL_R8 : depth ? depth_format() : GL_SRGB8_ALPHA8;
    info.sampleCount = has("samples") ? 4 : 1;
    info.width = has("big_swapchain") ? 5000 : size.recommendedImageRectWidth;
    info.height = size.recommendedImageRectHeight;
    if (depth && has("depth_size")) info.height /= 2;
    info.faceCount = info.mipCount = info.arraySize = 1;
    if (XR(xrCreateSwapchain, session, &info, &chain.handle) != XR_SUCCESS) return false;
    std::uint32_t count = 0;
    XR(xrEnumerateSwapchainImages, chain.handle, 0, &count, nullptr);
    chain.images.assign(count, {XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_KHR});
    XR(xrEnumerateSwapchainImages, chain.handle, count, &count,
       reinterpret_cast<XrSwapchainImageBaseHeader*>(chain.images.data()));
    chain.width = static_cast<int>(info.width);
    chain.height = static_cast<int>(info.height);
    return true;
  }

  bool make_chains() {
    const std::size_t count = sizes.size();
    colours.resize(count);
    depths.resize(has("depth") ? count : 0);
    for (std::size_t k = 0; k < count; ++k) {
      if (!make_chain(colours[k], sizes[k], false)) return false;
      if (has("depth") && !make_chain(depths[k], sizes[k], true)) return false;
    }
    return true;
  }

  void poll() {
    XrEventDataBuffer event = {XR_TYPE_EVENT_DATA_BUFFER};
    while (XR(xrPollEvent, instance, &event) == XR_SUCCESS) {
      if (event.type == XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED) {
        state = reinterpret_cast<const XrEventDataSessionStateChanged&>(event).state;
        on_state();
      } else if (event.type == XR_TYPE_EVENT_DATA_VISIBILITY_MASK_CHANGED_KHR) {
        const auto& changed = reinterpret_cast<const XrEventDataVisibilityMaskChangedKHR&>(event);
        say_mask(session, type, changed.viewIndex, frame);
      }
      event = {XR_TYPE_EVENT_DATA_BUFFER};
    }
  }

  void on_state() {
    const XrSessionBeginInfo info = {XR_TYPE_SESSION_BEGIN_INFO, nullptr, type};
    if (state == XR_SESSION_STATE_READY) {
      running = XR(xrBeginSession, session, &info) == XR_SUCCESS;
      if (has("begin_session_twice")) XR(xrBeginSession, session, &info);
    } else if (state == XR_SESSION_STATE_STOPPING && !has("does_not_stop")) {
      XR(xrEndSession, session);
      if (has("begin_stopped")) XR(xrBeginSession, session, &info);
      running = false;
    } else if (state == XR_SESSION_STATE_EXITING || state == XR_SESSION_STATE_LOSS_PENDING) {
      over = true;
    }
  }

  void draw(Chain& chain, std::size_t first, bool depth) {
    const bool hit = first == 0 && !depth;
    const XrSwapchainImageWaitInfo wait = {XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO, nullptr, XR_INFINITE_DURATION};
    if (hit && at("wait_without_acquire")) XR(xrWaitSwapchainImage, chain.handle, &wait);
    if (hit && at("release_without_acquire")) XR(xrReleaseSwapchainImage, chain.handle, nullptr);
    if (hit && at("stale_image")) return;
    if (depth && first == 0 && at("stale_depth")) return;
    XR(xrAcquireSwapchainImage, chain.handle, nullptr, &chain.index);
    if (hit && at("acquire_too_many")) {
      std::uint32_t more = 0;
      for (std::size_t k = 0; k < chain.images.size(); ++k)
        XR(xrAcquireSwapchainImage, chain.handle, nullptr, &more);
    }
    if (hit && at("release_without_wait")) XR(xrReleaseSwapchainImage, chain.handle, nullptr);
    while (XR(xrWaitSwapchainImage, chain.handle, &wait) == XR_TIMEOUT_EXPIRED) {
    }
    if (hit && at("wait_image_twice")) XR(xrWaitSwapchainImage, chain.handle, &wait);
    paint(chain, has("pictures_swapped") ? 1 - first : first, depth, frame);
    if (hit && at("not_released")) return;
    XR(xrReleaseSwapchainImage, chain.handle, nullptr);
    if (hit && at("drawn_after_release")) paint(chain, first + 1, depth, frame);
  }

  std::vector<XrView> locate(XrTime time) const {
    XrViewLocateInfo info = {XR_TYPE_VIEW_LOCATE_INFO, nullptr, type, time, space};
    if (at("locate_other_time")) info.displayTime += 5;
    if (at("locate_no_time")) info.displayTime = 0;
    if (at("locate_other_configuration"))
      info.viewConfigurationType = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_MONO;
    XrViewState view_state = {XR_TYPE_VIEW_STATE};
    std::vector<XrView> views(sizes.size(), {XR_TYPE_VIEW});
    auto count = static_cast<std::uint32_t>(views.size());
    XR(xrLocateViews, session, &info, &view_state, at("locate_small_array") ? 1 : count, &count,
       views.data());
    return views;
  }

  XrSwapchainSubImage image_of(const std::vector<Chain>& chains, std::size_t view) const {
    const Chain& chain = chains[view];
    return {chain.handle, {{0, 0}, {chain.width, chain.height}}, 0};
  }

  std::vector<XrCompositionLayerDepthInfoKHR> depth_infos() const {
    std::vector<XrCompositionLayerDepthInfoKHR> infos;
    for (std::size_t k = 0; k < (depths.empty() ? 0 : sizes.size()); ++k) {
      infos.push_back({XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR, nullptr,
                       image_of(depths, at("depth_of_other_eye") ? 1 - k : k), 0.0f, 1.0f, 0.1f, 100.0f});
      if (at("depth_twice")) infos[k].subImage = image_of(depths, 0);
      if (at("depth_range")) infos[k].maxDepth = 1.5f;
      if (at("depth_planes")) infos[k].farZ = infos[k].nearZ;
      if (at("depth_of_colours")) infos[k].subImage = image_of(colours, k);
    }
    return infos;
  }

  std::vector<XrCompositionLayerProjectionView> projections(
      const std::vector<XrView>& views, const std::vector<XrCompositionLayerDepthInfoKHR>& infos) const {
    std::vector<XrCompositionLayerProjectionView> out;
    for (std::size_t k = 0; k < sizes.size(); ++k) {
      out.push_back({XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW, infos.empty() ? nullptr : &infos[k],
                     views[at("eyes_swapped") ? 1 - k : k].pose, views[k].fov, image_of(colours, k)});
      if (at("stale_pose")) out[k].pose = last_views[k].pose;
      if (at("stale_fov")) out[k].fov = last_views[k].fov;
      if (at("rectangle_outside")) out[k].subImage.imageRect.offset.x = 1;
      if (at("array_index")) out[k].subImage.imageArrayIndex = 1;
      if (at("bad_pose")) out[k].pose.orientation = {0, 0, 0, 0};
      if (at("view_layer_type")) out[k].type = XR_TYPE_VIEW;
    }
    return out;
  }

  void end(const XrFrameState& now, const XrCompositionLayerProjection* projection) {
    XrFrameEndInfo info = {XR_TYPE_FRAME_END_INFO, nullptr, now.predictedDisplayTime,
                           XR_ENVIRONMENT_BLEND_MODE_OPAQUE};
    std::vector<const XrCompositionLayerBaseHeader*> layers;
    if (projection != nullptr) {
      layers.assign(at("too_many_layers") ? 17 : 1,
                    reinterpret_cast<const XrCompositionLayerBaseHeader*>(projection));
    }
    if (at("no_layer")) layers = {nullptr};
    if (at("wrong_time")) info.displayTime += 1;
    if (at("no_time")) info.displayTime = 0;
    if (at("blend_mode")) info.environmentBlendMode = XR_ENVIRONMENT_BLEND_MODE_ADDITIVE;
    info.layerCount = static_cast<std::uint32_t>(layers.size());
    info.layers = layers.data();
    XR(xrEndFrame, session, &info);
    if (at("end_twice")) XR(xrEndFrame, session, &info);
  }

  void run_frame() {
    XrFrameState now = {XR_TYPE_FRAME_STATE};
    if (at("begin_without_wait")) XR(xrBeginFrame, session, nullptr);
    if (XR(xrWaitFrame, session, nullptr, &now) < 0) {
      over = true;
      return;
    }
    if (at("wait_twice")) XR(xrWaitFrame, session, nullptr, &now);
    XR(xrBeginFrame, session, nullptr);
    if (at("frame_not_ended")) {
      XR(xrWaitFrame, session, nullptr, &now);
      XR(xrBeginFrame, session, nullptr);
    }
    if (at("end_session_early")) XR(xrEndSession, session);
    const std::vector<XrView> views = locate(now.predictedDisplayTime);
    if (has("actions")) actions.read(frame, space, now.predictedDisplayTime);
    const bool shows = now.shouldRender == XR_TRUE || has("always_shows");
    if (now.shouldRender == XR_TRUE && !has("never_draws")) {
      for (std::size_t k = 0; k < colours.size(); ++k) draw(colours[k], k, false);
      for (std::size_t k = 0; k < depths.size(); ++k) draw(depths[k], k, true);
    }
    const auto infos = depth_infos();
    const auto projected = projections(views, infos);
    XrCompositionLayerProjection layer = {
        XR_TYPE_COMPOSITION_LAYER_PROJECTION,         nullptr,         0, space,
        static_cast<std::uint32_t>(projected.size()), projected.data()};
    if (at("one_view")) layer.viewCount = 1;
    if (at("layer_type")) layer.type = XR_TYPE_VIEW;
    if (at("other_space")) layer.space = other_space;
    if (at("destroyed_space")) XR(xrDestroySpace, other_space), layer.space = other_space;
    if (at("destroyed_swapchain")) XR(xrDestroySwapchain, colours[0].handle);
    end(now, shows ? &layer : nullptr);
    last_views = views;
    ++frame;
  }

  /// The sizes that the runtime recommends now, where they are others than before.
  void say_sizes() {
    std::vector<XrViewConfigurationView> now(sizes.size(), {XR_TYPE_VIEW_CONFIGURATION_VIEW});
    auto count = static_cast<std::uint32_t>(now.size());
    XR(xrEnumerateViewConfigurationViews, instance, system, type, count, &count, now.data());
    for (std::size_t k = 0; k < now.size(); ++k) {
      const std::uint32_t width = now[k].recommendedImageRectWidth,
                          height = now[k].recommendedImageRectHeight;
      if (width != sizes[k].recommendedImageRectWidth || height != sizes[k].recommendedImageRectHeight) {
        std::printf("%d view %zu: %u x %u\n", frame, k, width, height);
      }
    }
    sizes = now;
  }

  void run_session() {
    running = over = false;
    if (!make_session() || !make_chains()) return;
    if (has("actions")) actions.make(session);
    if (has("mask")) say_mask(session, type, 0, frame);
    // A hundred frames of patience are the runtime's.
    while (!over && frame < 150) {
      poll();
      if (has("sizes")) say_sizes();
      if (running && !over) run_frame();
    }
  }

  void destroy_session() {
    if (!has("leaves_children")) {
      for (const auto* chains : {&colours, &depths}) {
        for (const Chain& chain : *chains) {
          if (chain.handle != XR_NULL_HANDLE) XR(xrDestroySwapchain, chain.handle);
        }
      }
      for (const XrSpace one : {space, other_space}) {
        if (one != XR_NULL_HANDLE) XR(xrDestroySpace, one);
      }
    }
    if (has("actions")) actions.destroy();
    XR(xrDestroySession, session);
  }

  void run() {
    make_context();
    if (!make_instance()) return;
    if (find_system()) run_session();
    if (has("leaves_all")) return;
    if (session != XR_NULL_HANDLE) destroy_session();
    if (has("again") && state == XR_SESSION_STATE_LOSS_PENDING) {
      run_session();
      destroy_session();
    }
    if (has("used_after")) XR(xrEndSession, session);
    XR(xrDestroyInstance, instance);
  }
};

}  // namespace
}  // namespace binosplat::xr_test

int main(int argc, char** argv) {
  using namespace binosplat::xr_test;
  words.insert(argv + 1, argv + argc);
  Client().run();
  return 0;
}
