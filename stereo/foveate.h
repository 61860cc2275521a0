#pragma once
// Foveated pictures: for each eye a window about its gaze, exact to the bit, and around it the same picture
// in fewer pixels, brought to one size on the GPU. Both are views of one frame and are projected together.

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

/// Throws Error for numbers that no eye has; `prefix` goes before their names.
void check(const Foveation& foveation, std::string_view prefix = "");

/// How one eye's picture is drawn, px.
struct FoveatedEye {
  glm::uvec2 inset_begin{0}, inset_end{0};  // the pixels that are exact
  double seam = 0.0;                        // the border's width around them
  shared::View context;                     // the picture in fewer pixels
  render::ViewRegion context_part;          // without what only the inset shows
  render::ViewRegion window;                // what is drawn of the eye's own view: the inset and its seam
};

/// What is drawn of an eye's view. `nth` is the eye's place in foveation.gaze. Throws Error for what check()
/// refuses, a list of gazes without that eye, and a gaze whose inset lies outside the picture.
FoveatedEye foveate(const shared::View& eye, const Foveation& foveation, std::size_t nth = 0);

/// The views of a frame that draws these eyes, two each (its context, then its window), and the frame's
/// settings, whose tolerance is for the contexts. The insets are exact.
struct FoveatedViews {
  std::vector<FoveatedEye> eyes;
  std::vector<shared::View> views;
  render::FrameSettings settings;
};

/// Throws Error for more than MAX_VIEWS / 2 eyes, for settings that already have regions or ask for the
/// median depth, and as foveate() does.
FoveatedViews foveated_views(std::span<const shared::View> eyes, const Foveation& foveation,
                             const render::FrameSettings& settings = {});

class FoveatedFrame {
 public:
  explicit FoveatedFrame(std::shared_ptr<render::GpuModel> model)
      : frame_(std::move(model)),
        colours_(frame_.model()->context(), "foveated pixels"),
        z_sums_(frame_.model()->context(), "their depth"),
        canvases_(frame_.model()->context(), "their canvases") {}

  /// Draws all eyes in one frame and composes their pictures, which is a stage of its own, "compose". With
  /// canvases, one an eye, the pictures are there and nowhere else, over settings.background. With mesh
  /// depths, too one an eye, what lies behind is not drawn, and there must be canvases. Throws as
  /// foveated_views() and render::Frame::draw() do.
  render::FrameReport draw(std::span<const shared::View> eyes, const Foveation& foveation,
                           const render::FrameSettings& settings = {}, const render::Workings& workings = {},
                           const render::CallersTextures& textures = {}) {
    submit(eyes, foveation, settings, workings, textures);
    return finish();
  }

  /// The same in two calls, as those of frame().
  void submit(std::span<const shared::View> eyes, const Foveation& foveation,
              const render::FrameSettings& settings = {}, const render::Workings& workings = {},
              const render::CallersTextures& textures = {}) {
    hand_over(eyes, foveation, settings, workings, textures, &render::Frame::submit);
  }
  render::FrameReport finish();

  /// As render::Frame::prepare().
  void prepare(std::span<const shared::View> eyes, const Foveation& foveation,
               const render::FrameSettings& settings, const render::CallersTextures& textures) {
    hand_over(eyes, foveation, settings, {}, textures, &render::Frame::prepare);
  }

  /// The composed pictures of the last frame, one an eye; and on the GPU, as a frame's lie: vec4 (C, T) by
  /// pixel, a view's from its pixel_offset on; unless they went onto canvases.
  std::vector<Picture> read_pictures() const;
  const gl::Buffer& colours() const { return colours_; }
  const std::vector<shared::View>& views() const { return eyes_; }

  /// What the last frame drew of each eye.
  const std::vector<FoveatedEye>& parts() const { return parts_; }
  /// What draws the parts: twice as many views.
  render::Frame& frame() { return frame_; }

 private:
  void hand_over(std::span<const shared::View> eyes, const Foveation& foveation,
                 const render::FrameSettings& settings, const render::Workings& workings,
                 const render::CallersTextures& textures, decltype(&render::Frame::submit) to);
  void compose(gl::Dispatcher& dispatcher);
  void compose_eye(gl::Dispatcher& dispatcher, std::size_t k);

  render::Frame frame_;
  gl::Buffer colours_, z_sums_, canvases_;
  // Of the frame that was submitted last:
  std::vector<render::Canvas> to_;  // empty: into the buffers above
  bool among_meshes_ = false;
  glm::vec3 background_{0.0f};
  std::vector<shared::View> eyes_;
  std::vector<FoveatedEye> parts_;
};

}  // namespace binosplat::stereo
