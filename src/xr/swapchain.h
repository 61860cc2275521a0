#pragma once
// Pictures that the runtime shows: a ring of textures, of which one is drawn into at a time.

#include <glm/glm.hpp>
#include <vector>

#include "xr/session.h"

namespace binosplat::xr {

class Swapchain {
 public:
  /// 2D textures of a format that the runtime offers, of one sample. Throws Error(no_gl) where it makes none.
  Swapchain(const Session& session, std::int64_t format, const glm::ivec2& size, XrSwapchainUsageFlags usage);
  ~Swapchain();
  Swapchain(const Swapchain&) = delete;
  Swapchain& operator=(const Swapchain&) = delete;

  const glm::ivec2& size() const { return size_; }

  /// Waits until the runtime has read a texture, and returns its name. Call release() before the frame ends.
  std::uint32_t acquire();
  void release();

  /// The part of it that a frame shows.
  XrSwapchainSubImage part(const glm::ivec2& size) const;

 private:
  const Api& api_;
  XrSwapchain swapchain_ = XR_NULL_HANDLE;
  glm::ivec2 size_;
  std::vector<std::uint32_t> textures_;
};

/// What the runtime offers, its favourites first: OpenGL's internal formats.
std::vector<std::int64_t> swapchain_formats(const Session& session);

}  // namespace binosplat::xr
