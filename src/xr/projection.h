#pragma once
// What a headset shows: a frame's pictures and depths in the runtime's textures, with exactly the poses and
// angles that they were drawn from.

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "stereo/eyes.h"
#include "stereo/foveate.h"
#include "stereo/present.h"
#include "xr/swapchain.h"
#include "xr/visibility.h"

namespace binosplat::xr {

/// How the views of a headset are drawn.
struct ProjectionSettings {
  double scale = 1.0;                // sides of the textures over those that the runtime recommends
  double near_plane = near_default;  // world units, while a metre has units_per_metre of them
  double units_per_metre = 1.0;
  glm::vec3 background{0.0f};
  /// For a headset with two views; one with four has insets of its own. No depths go with composed pictures.
  std::optional<stereo::Foveation> foveation;
};

class Projection {
 public:
  /// Makes textures of the recommended sizes times the scale, at most the largest that the runtime allows.
  Projection(const Session& session, gl::Context& context, const ProjectionSettings& settings);

  /// How a frame is drawn, besides its settings.
  struct Draw {
    double scale = 1.0;                // sides of the pictures over those of the textures
    std::optional<XrPosef> gaze = {};  // where the foveated eyes look, if it is known
    /// Called while the left eye's texture may still be read: its picture, of `size` px, lies there in the
    /// lower left corner.
    std::function<void(const Target& left, const glm::ivec2& size)> drawn_left = {};
  };
  /// Draws the located views at a place of the model's world.
  render::FrameReport draw(stereo::FoveatedFrame& frame, std::span<const XrView> located,
                           const Placement& placement, render::FrameSettings settings, const Draw& draw);

  /// Whether the runtime recommends other sizes now: a new Projection would have them.
  bool outdated() const { return sizes_ != sizes_now(); }

  /// Asks the runtime anew what its lenses show.
  void take_masks();

  /// The frame that was drawn last, for Session::end_frame.
  const XrCompositionLayerBaseHeader* layer() const;

  /// The sizes, "GL_SRGB8_ALPHA8", and whether depths go with it: for people.
  std::string description() const;

 private:
  struct Eye {
    std::unique_ptr<Swapchain> colours, depths;
    Visible visible;
  };
  std::vector<glm::ivec2> sizes_now() const;
  bool foveates() const { return settings_.foveation && eyes_.size() == 2; }
  /// Depths go from the nearest to the farthest, m.
  void submit(std::span<const XrView> located, std::span<const glm::ivec2> sizes, double nearest,
              double farthest);
  /// Make the textures, of formats that the runtime offers.
  void make_colours(std::span<const std::int64_t> offered);
  void make_depths(std::span<const std::int64_t> offered);
  std::vector<render::ViewRegion> parts_of(const render::FrameSettings& settings,
                                           std::span<const XrView> located,
                                           std::span<const glm::ivec2> sizes) const;

  const Session& session_;
  ProjectionSettings settings_;
  stereo::Presenter presenter_;
  std::int64_t format_ = 0;
  bool linear_ = false;   // numbers of the format mean light
  bool in_place_ = true;  // shaders may write into the textures
  std::vector<glm::ivec2> sizes_;
  std::vector<Eye> eyes_;
  std::vector<XrCompositionLayerDepthInfoKHR> depth_infos_;
  std::vector<XrCompositionLayerProjectionView> views_;
  XrCompositionLayerProjection layer_;
};

/// The eye as the library takes it.
Eye eye_of(const XrPosef& pose, const XrFovf& fov = {});

}  // namespace binosplat::xr
