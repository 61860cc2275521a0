#pragma once
// What a headset shows: the runtime's textures that a frame's pictures and depths are drawn into, with
// exactly the poses and angles that they were drawn from.

#include <binosplat/renderer.h>

#include "xr/session.h"

namespace binosplat::xr {

/// A ring of the runtime's textures, of which one is drawn into at a time.
struct Swapchain {
  /// 2D textures of one sample, of a format that the runtime offers, for `usage` and, where it lets them, for
  /// `more`. Throws Error(no_gl) where it makes none.
  Swapchain(const Session& session, std::int64_t format, const glm::ivec2& wanted,
            XrSwapchainUsageFlags usage, XrSwapchainUsageFlags more = 0);

  /// Waits until the runtime has read a texture, and returns its name. Call release() before the frame ends.
  std::uint32_t acquire() const;
  void release() const { XR(ReleaseSwapchainImage, handle.get(), nullptr); }

  Owned<XrSwapchain> handle;
  glm::ivec2 size;       // px
  bool has_more = true;  // uses
  std::vector<std::uint32_t> textures;
};

/// What a lens shows of a view (XR_KHR_visibility_mask): triangles at a distance of 1 ahead, x right and y
/// up, that hold all that can be seen. Empty: all of the view.
struct Mask {
  std::vector<XrVector2f> vertices;
  std::vector<std::uint32_t> indices;  // three a triangle
};

/// For each row of tiles of a picture the columns that a lens shows, as ViewRegion has them, with a margin of
/// a pixel. Empty: all.
std::vector<glm::uvec2> visible_columns(const Mask& mask, const Fov& fov, const glm::ivec2& size);

class Projection {
 public:
  /// Makes textures of the recommended sizes times the scale, at most the largest that the runtime allows.
  /// `composed`: of pictures with insets of their own, which have neither depths nor regions.
  Projection(const Session& session, double scale, bool composed);

  /// Takes textures from the runtime for the located views, and returns what is to be drawn of them: pictures
  /// of `scale` times the sides of the textures. An eye's views lie side by side. Of four, the wide ones have
  /// holes where the insets are, which are exact unless the settings have a quality.
  std::vector<View> begin(std::span<const XrView> located, const Placement& placement, double scale,
                          const Settings& settings);

  /// Gives the textures back, drawn, and ends the session's frame with them.
  void end(XrTime display, std::span<const XrView> located, std::span<const View> drawn,
           const Placement& placement) const;

  /// Asks the runtime what its lenses show.
  void take_masks();

  /// The sizes, "GL_SRGB8_ALPHA8", and whether depths go with it: for people.
  std::string description() const;

 private:
  /// What belongs to a view of the runtime's.
  struct OfView {
    Swapchain colours;
    std::optional<Swapchain> depths = {};
    Mask mask = {};
  };
  const Session& session_;
  const bool composed_;
  std::vector<OfView> of_views_;
};

/// The eye as the library takes it.
Eye eye_of(const XrPosef& pose, const XrFovf& fov = {});

/// Where each eye looks, as Foveation::gaze has it, a little within its picture.
std::vector<glm::dvec2> gaze_of(const XrPosef& gaze, std::span<const XrView> located);

}  // namespace binosplat::xr
