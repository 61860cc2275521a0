#pragma once
// Draws frames of a model: whole, or foveated if their settings say so.

#include <memory>
#include <span>
#include <vector>

#include "base/image.h"
#include "gl/dispatch.h"
#include "render/frame.h"
#include "stereo/foveate.h"

namespace binosplat::stereo {

class Drawing {
 public:
  explicit Drawing(std::shared_ptr<render::GpuModel> model)
      : frame_(std::move(model)),
        colours_(frame_.model()->context(), "foveated pixels"),
        z_sums_(frame_.model()->context(), "their depth"),
        canvases_(frame_.model()->context(), "their canvases") {}

  /// Draws as render::Frame does. With settings.foveation, draws all eyes in one frame and composes their
  /// pictures in a further stage, "compose". If `textures` then has canvases, one per eye, the pictures are
  /// written only there, over settings.background. Mesh depths, also one per eye, require canvases; splats
  /// behind meshes are not drawn. Throws as foveated_views() and render::Frame::draw() do.
  Report draw(std::span<const shared::View> eyes, const render::FrameSettings& settings = {},
              const render::DebugOptions& debug = {}, const render::CallersTextures& textures = {}) {
    submit(eyes, settings, debug, textures);
    return finish();
  }

  /// Draws in two calls, as render::Frame does.
  void submit(std::span<const shared::View> eyes, const render::FrameSettings& settings = {},
              const render::DebugOptions& debug = {}, const render::CallersTextures& textures = {}) {
    forward_views(eyes, settings, debug, textures, &render::Frame::submit);
  }
  Report finish();

  void prepare(std::span<const shared::View> eyes, const render::FrameSettings& settings,
               const render::CallersTextures& textures) {
    forward_views(eyes, settings, {}, textures, &render::Frame::prepare);
  }

  /// The pictures of the last frame, one per eye. colours() has them on the GPU as Frame::colours() does:
  /// vec4 (C, T) by pixel; each view begins at its pixel_offset. After a frame on canvases, read_pictures()
  /// throws Error, and colours() is undefined.
  std::vector<Picture> read_pictures() const;
  const gl::Buffer& colours() const { return is_foveated() ? colours_ : frame_.colours(); }
  std::span<const shared::View> views() const { return is_foveated() ? eyes_ : frame_.views(); }

  /// The parts of a foveated frame, one per eye; empty for a whole one.
  const std::vector<FoveatedEye>& parts() const { return parts_; }
  /// The frame that draws the views. For a foveated frame, it has two per eye.
  render::Frame& frame() { return frame_; }

 private:
  bool is_foveated() const { return !parts_.empty(); }
  void forward_views(std::span<const shared::View> eyes, const render::FrameSettings& settings,
                     const render::DebugOptions& debug, const render::CallersTextures& textures,
                     decltype(&render::Frame::submit) to);
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
