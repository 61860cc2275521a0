#include "xr/swapchain.h"

#include "base/error.h"
#include "xr/platform.h"

namespace binosplat::xr {

Swapchain::Swapchain(const Session& session, std::int64_t format, const glm::ivec2& size,
                     XrSwapchainUsageFlags usage)
    : api_(session.instance().api()), size_(size) {
  XrSwapchainCreateInfo info{XR_TYPE_SWAPCHAIN_CREATE_INFO};
  info.usageFlags = usage;
  info.format = format;
  info.sampleCount = info.faceCount = info.arraySize = info.mipCount = 1;
  info.width = static_cast<std::uint32_t>(size.x);
  info.height = static_cast<std::uint32_t>(size.y);
  check(api_.CreateSwapchain(session.handle(), &info, &swapchain_), "xrCreateSwapchain");
  XrSwapchainImageOpenGLKHR empty{};
  empty.type = XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_KHR;
  const auto images =
      all_of("xrEnumerateSwapchainImages", empty,
             [&](std::uint32_t room, std::uint32_t* count, XrSwapchainImageOpenGLKHR* all) {
               return api_.EnumerateSwapchainImages(swapchain_, room, count,
                                                    reinterpret_cast<XrSwapchainImageBaseHeader*>(all));
             });
  for (const XrSwapchainImageOpenGLKHR& image : images) textures_.push_back(image.image);
}

Swapchain::~Swapchain() { api_.DestroySwapchain(swapchain_); }

std::uint32_t Swapchain::acquire() {
  std::uint32_t index = 0;
  check(api_.AcquireSwapchainImage(swapchain_, nullptr, &index), "xrAcquireSwapchainImage");
  XrSwapchainImageWaitInfo wait{XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO};
  wait.timeout = XR_INFINITE_DURATION;
  check(api_.WaitSwapchainImage(swapchain_, &wait), "xrWaitSwapchainImage");
  return textures_.at(index);
}

void Swapchain::release() {
  check(api_.ReleaseSwapchainImage(swapchain_, nullptr), "xrReleaseSwapchainImage");
}

XrSwapchainSubImage Swapchain::part(const glm::ivec2& size) const {
  return {swapchain_, {{0, 0}, {size.x, size.y}}, 0};
}

std::vector<std::int64_t> swapchain_formats(const Session& session) {
  return all_of<std::int64_t>(
      "xrEnumerateSwapchainFormats", {}, [&](std::uint32_t room, std::uint32_t* count, std::int64_t* all) {
        return session.instance().api().EnumerateSwapchainFormats(session.handle(), room, count, all);
      });
}

}  // namespace binosplat::xr
