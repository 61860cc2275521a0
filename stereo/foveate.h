#pragma once
// Foveated pictures: each eye has an inset around its gaze, exact to the bit. The context around the inset
// has fewer pixels, and the GPU scales it up. Inset and context are views of one frame and are projected
// together.

#include <binosplat/settings.h>

#include <array>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/image.h"
#include "gl/dispatch.h"
#include "render/frame.h"

namespace binosplat::stereo {

using Foveation = binosplat::Foveation;

/// Throws Error for illegal numbers; `prefix` precedes their names in the text.
void check(const Foveation& foveation, std::string_view prefix = "");

/// The parts of one eye's picture, px. The context has a hole where only the inset is visible.
struct FoveatedEye {
  glm::uvec2 inset_begin{0}, inset_end{0};  // the exact pixels
  double seam = 0.0;                        // width of the border around the inset
  shared::View context;                     // the context's view, with fewer pixels
  render::ViewRegion context_region;        // the drawn part of the context: all but the hole
  render::ViewRegion window;                // the drawn part of the full-size view: inset and seam
};

/// Plans the parts of an eye's view. `nth` is the eye's index in foveation.gaze. Throws Error as check()
/// does, if the list of gazes lacks this eye, and if the inset lies outside the picture.
FoveatedEye foveate(const shared::View& eye, const Foveation& foveation, std::size_t nth = 0);

/// The views of a frame that draws these eyes, two per eye (its context, then its window), and the frame's
/// settings. The tolerance applies to the contexts; the insets are exact.
struct FoveatedViews {
  std::vector<FoveatedEye> eyes;
  std::vector<shared::View> views;
  render::FrameSettings settings;
};

/// Throws Error for more than MAX_VIEWS / 2 eyes, for settings with regions or the median depth, and as
/// foveate() does.
FoveatedViews foveated_views(std::span<const shared::View> eyes, const Foveation& foveation,
                             const render::FrameSettings& settings = {});

class FoveatedFrame {
 public:
  explicit FoveatedFrame(std::shared_ptr<render::GpuModel> model)
      : frame_(std::move(model)),
        colours_(frame_.model()->context(), "foveated pixels"),
        z_sums_(frame_.model()->context(), "their depth"),
        canvases_(frame_.model()->context(), "their canvases") {}

  /// Draws all eyes in one frame and composes their pictures in a further stage, "compose". If `textures` has
  /// canvases, one per eye, the pictures are written only there, over settings.background. Mesh depths, also
  /// one per eye, require canvases; splats behind meshes are not drawn. Throws as foveated_views() and
  /// render::Frame::draw() do.
  Report draw(std::span<const shared::View> eyes, const Foveation& foveation,
              const render::FrameSettings& settings = {}, const render::DebugOptions& debug = {},
              const render::CallersTextures& textures = {}) {
    submit(eyes, foveation, settings, debug, textures);
    return finish();
  }

  /// Draws in two calls, as render::Frame does.
  void submit(std::span<const shared::View> eyes, const Foveation& foveation,
              const render::FrameSettings& settings = {}, const render::DebugOptions& debug = {},
              const render::CallersTextures& textures = {}) {
    submit_or_prepare(eyes, foveation, settings, debug, textures, &render::Frame::submit);
  }
  Report finish();

  void prepare(std::span<const shared::View> eyes, const Foveation& foveation,
               const render::FrameSettings& settings, const render::CallersTextures& textures) {
    submit_or_prepare(eyes, foveation, settings, {}, textures, &render::Frame::prepare);
  }

  /// The composed pictures of the last frame, one per eye. colours() has them on the GPU as Frame::colours()
  /// does: vec4 (C, T) by pixel; each view begins at its pixel_offset. After a frame on canvases,
  /// read_pictures() throws Error, and colours() is undefined.
  std::vector<Picture> read_pictures() const;
  const gl::Buffer& colours() const { return colours_; }
  const std::vector<shared::View>& views() const { return eyes_; }

  const std::vector<FoveatedEye>& parts() const { return parts_; }
  /// The frame that draws the parts, with two views per eye.
  render::Frame& frame() { return frame_; }

 private:
  void submit_or_prepare(std::span<const shared::View> eyes, const Foveation& foveation,
                         const render::FrameSettings& settings, const render::DebugOptions& debug,
                         const render::CallersTextures& textures, decltype(&render::Frame::submit) to);
  void compose(gl::Dispatcher& dispatcher);
  void compose_eye(gl::Dispatcher& dispatcher, std::size_t k);

  render::Frame frame_;
  gl::Buffer colours_, z_sums_, canvases_;
  // Of the last submitted frame:
  std::vector<render::Canvas> to_;  // empty: the pictures go into the buffers above
  bool has_mesh_depths_ = false;
  glm::vec3 background_{0.0f};
  std::vector<shared::View> eyes_;
  std::vector<FoveatedEye> parts_;
};

}  // namespace binosplat::stereo
