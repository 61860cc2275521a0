#pragma once
// A frame's pictures into any texture or framebuffer of the context, by the layouts of stereo/layout.h. Waits
// for nothing. Textures that a compute shader can write are written in place; others, and framebuffers, are
// copied into.

#include <binosplat/targets.h>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>

#include "base/image.h"
#include "gl/dispatch.h"
#include "gl/texture.h"
#include "render/frame.h"
#include "scene/camera.h"
#include "shared/axes.h"

namespace binosplat::stereo {

/// render::Canvas by view, and the texture views that they use.
struct Canvases {
  std::vector<render::Canvas> list;
  std::vector<std::unique_ptr<gl::Texture>> views;  // of targets that are sRGB textures, or are read, too
};

/// The CallersTextures::depth_rows with which a frame on canvases knows enough depths to fill these targets.
int depth_rows(const gl::Context& context, std::span<const shared::View> views,
               std::span<const DepthTarget> targets);

/// What a picture is shown over: a colour, nothing, or, with mesh depths, what is in the target already.
struct Backdrop {
  Backdrop(const Background& colour, bool is_there = false) : background(colour), is_in_target(is_there) {}
  Backdrop(const glm::vec3& colour) : background(colour) {}

  Background background;
  bool is_in_target = false;
};

class Presenter {
 public:
  explicit Presenter(gl::Context& context) : dispatcher_(context), nearest_(context) {}
  ~Presenter();
  Presenter(const Presenter&) = delete;
  Presenter& operator=(const Presenter&) = delete;

  /// Draws view `first` of the last frame (LAYOUT_SEPARATE), or views `first` and `first + 1` as left and
  /// right eye in another layout; layout_size() says how many px that takes. The picture's top is the
  /// texture's top as OpenGL sees it, t = 1.
  ///
  /// Colours are display-referred, as trained, and written as they are, without conversion by
  /// GL_FRAMEBUFFER_SRGB: what a window shows, and what a texture of format SRGB8_ALPHA8 means. Without a
  /// background they are premultiplied by the alpha beside them. All draw buffers of a framebuffer get the
  /// picture; blending, masks and tests do not touch it. All state is as before afterwards (gl/state.h), and
  /// whatever reads the target next sees the picture. Throws Error(bad_input) for views that are not there or
  /// differ in size, a target that cannot be drawn into, and what layout_size() and lay_out() refuse.
  ///
  /// A frame with mesh depths goes over the colours that are there, premultiplied by the alpha beside them,
  /// whatever the background (LAYOUT_SEPARATE).
  void draw(const render::Frame& frame, std::size_t first, int layout, const Target& target,
            const Background& background = glm::vec3(0.0f)) {
    draw(frame.colours(), frame.views(), first, layout, target,
         {background, !frame.plan().meshes.depths.empty()});
  }

  /// The same of other pictures that lie in a buffer as a frame's do: vec4 (C, T) by pixel, a view's from its
  /// pixel_offset on.
  void draw(const gl::Buffer& colours, std::span<const shared::View> views, std::size_t first, int layout,
            const Target& target, const Backdrop& backdrop);

  /// Compiles the programs of draw(), over a colour or what is in the target, and, where `frame` tells depths
  /// to be written, of draw_depth().
  void prepare(const render::Frame& frame, bool with_depths);

  /// The canvases through which a frame's own blend may draw into these targets, one a view
  /// (LAYOUT_SEPARATE): the same bits as draw() writes afterwards, in less time. None for more than
  /// MAX_CANVASES targets, or where one of them takes a copy. Throws as draw() does.
  Canvases canvases(std::span<const Target> targets, const Background& background, bool over_target = false);

  /// Fills all of a target with the depths of view `v` of the last frame. State as for draw(). Throws
  /// Error(bad_input) for a view that is not there, a frame drawn without depth, a target that is no such
  /// texture, and planes that bound nothing.
  void draw_depth(const render::Frame& frame, std::size_t v, const DepthTarget& target);

 private:
  void attach(std::uint32_t framebuffer, GLenum place, std::uint32_t texture, int level, int layer,
              const char* kind);
  std::uint32_t framebuffer_of(const Target& target);
  const gl::Texture& scratch(const glm::ivec2& size, GLenum format);
  void copy(const glm::ivec2& size, std::uint32_t to, const glm::ivec2& corner);
  void copy_back(const glm::ivec2& size, std::uint32_t from, const glm::ivec2& corner);

  gl::Dispatcher dispatcher_;
  gl::Sampler nearest_;
  // Made at first use: of the caller's textures, and of what is copied into framebuffers.
  std::uint32_t target_framebuffer_ = 0, scratch_framebuffer_ = 0;
  std::unique_ptr<gl::Texture> scratch_;
  std::uint32_t depth_framebuffer_ = 0, no_vertices_ = 0;
};

}  // namespace binosplat::stereo
