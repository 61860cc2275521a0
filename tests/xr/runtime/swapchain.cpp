// Swapchains and their images.

#include <algorithm>

#include "xr/runtime/api.h"

namespace binosplat::xr_test::api {

XrResult enumerate_swapchain_formats(XrSession handle, std::uint32_t capacity, std::uint32_t* count,
                                     std::int64_t* formats) {
  runtime().get<Session>(handle);
  const auto& all = runtime().script.formats;
  return fill(all.size(), capacity, count, formats, [&](std::size_t k) { formats[k] = all[k]; });
}

XrResult create_swapchain(XrSession handle, const XrSwapchainCreateInfo* info, XrSwapchain* out) {
  Runtime& r = runtime();
  const auto& session = r.get<Session>(handle);
  checked(info, XR_TYPE_SWAPCHAIN_CREATE_INFO);
  require(std::count(r.script.formats.begin(), r.script.formats.end(), info->format) != 0,
          XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED, "format " + std::to_string(info->format));
  require(info->width > 0 && info->height > 0 && info->width <= 4096 && info->height <= 4096,
          XR_ERROR_SWAPCHAIN_RECT_INVALID,
          "a swapchain of " + std::to_string(info->width) + " x " + std::to_string(info->height));
  require(info->arraySize > 0 && info->mipCount > 0 && info->faceCount > 0 && info->sampleCount > 0,
          XR_ERROR_VALIDATION_FAILURE, "a swapchain of no layers, levels, faces or samples");
  require(info->sampleCount == 1 && info->faceCount == 1 && info->arraySize == 1,
          XR_ERROR_FEATURE_UNSUPPORTED, "a swapchain of several samples, faces or layers");
  const bool depth = is_depth(info->format);
  const XrSwapchainUsageFlags wrong =
      depth ? XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT : XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
  require((info->usageFlags & wrong) == 0, XR_ERROR_VALIDATION_FAILURE, "a usage that is not the format's");
  // No fault of the client's: it may ask.
  if (info->format == GL_SRGB8_ALPHA8 && !r.script.unordered_srgb &&
      (info->usageFlags & XR_SWAPCHAIN_USAGE_UNORDERED_ACCESS_BIT) != 0)
    return XR_ERROR_FEATURE_UNSUPPORTED;
  auto& swapchain = r.add<Swapchain>(session.id);
  swapchain.info = *info;
  swapchain.info.next = nullptr;
  swapchain.depth = depth;
  const Current current(session.binding);
  const int images = depth ? 2 : 3;
  for (int k = 0; k < images; ++k) {
    swapchain.textures.push_back(make_texture(session.binding, *info, r.script.immutable));
  }
  r.log({{"what", "swapchain"},
         {"id", swapchain.id},
         {"format", info->format},
         {"width", info->width},
         {"height", info->height},
         {"usage", info->usageFlags},
         {"images", images}});
  *out = handle_of<XrSwapchain>(swapchain);
  return XR_SUCCESS;
}

XrResult destroy_swapchain(XrSwapchain handle) {
  auto& swapchain = runtime().get<Swapchain>(handle, true);
  if (!swapchain.acquired.empty()) runtime().fault("an image was not released");
  runtime().destroy(swapchain);
  return XR_SUCCESS;
}

XrResult enumerate_swapchain_images(XrSwapchain handle, std::uint32_t capacity, std::uint32_t* count,
                                    XrSwapchainImageBaseHeader* images) {
  const auto& swapchain = runtime().get<Swapchain>(handle);
  auto* out = reinterpret_cast<XrSwapchainImageOpenGLKHR*>(images);
  return fill(swapchain.textures.size(), capacity, count, images, [&](std::size_t k) {
    checked(&out[k], XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_KHR);
    out[k].image = swapchain.textures[k];
  });
}

XrResult acquire_swapchain_image(XrSwapchain handle, const XrSwapchainImageAcquireInfo* info,
                                 std::uint32_t* index) {
  auto& swapchain = runtime().get<Swapchain>(handle);
  check_if_any(info, XR_TYPE_SWAPCHAIN_IMAGE_ACQUIRE_INFO);
  require(index != nullptr, XR_ERROR_VALIDATION_FAILURE, "nowhere to put an index");
  require(swapchain.acquired.size() < swapchain.textures.size(), XR_ERROR_CALL_ORDER_INVALID,
          "all images are acquired already");
  *index = swapchain.next;
  swapchain.acquired.push_back(swapchain.next);
  swapchain.next = (swapchain.next + 1) % static_cast<std::uint32_t>(swapchain.textures.size());
  return XR_SUCCESS;
}

XrResult wait_swapchain_image(XrSwapchain handle, const XrSwapchainImageWaitInfo* info) {
  auto& swapchain = runtime().get<Swapchain>(handle);
  checked(info, XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO);
  require(!swapchain.acquired.empty(), XR_ERROR_CALL_ORDER_INVALID, "no image is acquired");
  require(!swapchain.waited, XR_ERROR_CALL_ORDER_INVALID, "an image was waited for and not yet released");
  swapchain.waited = true;
  return XR_SUCCESS;
}

XrResult release_swapchain_image(XrSwapchain handle, const XrSwapchainImageReleaseInfo* info) {
  Runtime& r = runtime();
  auto& swapchain = r.get<Swapchain>(handle);
  check_if_any(info, XR_TYPE_SWAPCHAIN_IMAGE_RELEASE_INFO);
  require(!swapchain.acquired.empty(), XR_ERROR_CALL_ORDER_INVALID, "no image is acquired");
  require(swapchain.waited, XR_ERROR_CALL_ORDER_INVALID, "the image was not waited for");
  swapchain.waited = false;
  swapchain.released = swapchain.acquired.front();
  swapchain.acquired.pop_front();
  swapchain.released_frame = r.frame();
  swapchain.pixels.clear();
  if (!r.script.keeps_pixels(r.frame())) return XR_SUCCESS;
  const Binding& gl = r.session()->binding;
  const Current current(gl);
  swapchain.pixels = read_texture(gl, swapchain.textures[*swapchain.released], swapchain.info);
  return XR_SUCCESS;
}

}  // namespace binosplat::xr_test::api
