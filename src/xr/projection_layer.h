#pragma once
// The projection layer of a session: the runtime's textures for colours and depths, submitted with exactly
// the poses and angles that were drawn.

#include <binosplat/renderer.h>

#include "xr/session.h"

namespace binosplat::xr {

/// A ring of the runtime's textures. One at a time is acquired and drawn.
struct Swapchain {
  /// Creates 2D textures with one sample. The runtime must offer `format`. `usage` is required; `more` is
  /// added if the runtime allows it. Throws Error(no_gl) if the runtime creates none.
  Swapchain(const Session& session, std::int64_t format, const glm::ivec2& wanted,
            XrSwapchainUsageFlags usage, XrSwapchainUsageFlags more = 0);

  /// Waits until the runtime has read a texture, and returns the texture's name. Call release() before the
  /// frame ends.
  std::uint32_t acquire() const;
  void release() const { XR(ReleaseSwapchainImage, handle.get(), nullptr); }

  Owned<XrSwapchain> handle;
  glm::ivec2 size;       // px
  bool has_more = true;  // the runtime allowed `more`
  std::vector<std::uint32_t> textures;
};

/// The visible part of a view (XR_KHR_visibility_mask): triangles in the plane at distance 1 in front of the
/// eye, x right and y up. Empty: all of the view.
struct Mask {
  std::vector<XrVector2f> vertices;
  std::vector<std::uint32_t> indices;  // three per triangle
};

/// Returns ViewRegion::columns: for each row of tiles of a picture, the range [x, y) of the tile columns
/// that are visible through the lens, with a margin of a pixel. Empty: all.
std::vector<glm::uvec2> visible_columns(const Mask& mask, const Fov& fov, const glm::ivec2& size);

class ProjectionLayer {
 public:
  /// Creates textures of the recommended sizes times `scale`, limited by the runtime's maximum. `composed`:
  /// for foveated pictures, which have neither depths nor regions.
  ProjectionLayer(const Session& session, double scale, bool composed);

  /// Acquires textures for the located views, and returns the views to draw: each picture has `scale` times
  /// its texture's width and height. The views of an eye are adjacent. Of four views, the wide ones have
  /// holes for the insets. Insets are exact unless the settings have a quality.
  std::vector<View> begin(std::span<const XrView> located, const Placement& placement, double scale,
                          const Settings& settings);

  /// Releases the drawn textures, and ends the session's frame with them.
  void end(XrTime display, std::span<const XrView> located, std::span<const View> drawn,
           const Placement& placement) const;

  void take_masks();

  /// Describes sizes, format and depths for the log.
  std::string description() const;

 private:
  struct ViewTextures {
    Swapchain colours;
    std::optional<Swapchain> depths = {};
    Mask mask = {};
  };
  const Session& session_;
  const bool composed_;
  std::vector<ViewTextures> view_textures_;
};

Eye eye_of(const XrPosef& pose, const XrFovf& fov = {});

/// The gaze of each eye, for Foveation::gaze, clamped to slightly inside the eye's picture.
std::vector<glm::dvec2> gaze_of(const XrPosef& gaze, std::span<const XrView> located);

}  // namespace binosplat::xr
