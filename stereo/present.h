#pragma once
// Writes a frame's pictures into any texture or framebuffer of the context, in the layouts of
// stereo/layout.h, without waiting for the GPU. If a compute shader can write a texture, it does so in place.
// Other textures, and framebuffers, get a copy.

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

namespace binosplat::stereo {

/// One render::Canvas per view, and the texture views that the canvases use.
struct Canvases {
  std::vector<render::Canvas> list;
  std::vector<std::unique_ptr<gl::Texture>> views;  // for targets that are sRGB textures, or are also read
};

/// Returns CallersTextures::depth_rows for a frame on canvases: 2 if each target has at most half as many
/// rows as its view, else 1.
int depth_rows(const gl::Context& context, std::span<const shared::View> views,
               std::span<const DepthTarget> targets);

/// The background of a picture: a colour, none, or, with mesh depths, the target's own colours.
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
  /// right eye in another layout; layout_size() returns the size in px. The picture's top is the texture's
  /// top in OpenGL, t = 1.
  ///
  /// Colours are display-referred, as trained, and GL_FRAMEBUFFER_SRGB does not convert them. A window shows
  /// display-referred values, and a texture of format SRGB8_ALPHA8 holds them. Without a background, colours
  /// are premultiplied by alpha. All draw buffers of a framebuffer receive the picture; blending, masks and
  /// tests do not affect it. The context's state is restored (gl/state.h), and later reads of the target see
  /// the picture. A frame with mesh depths is blended over the target's colours, premultiplied by alpha, and
  /// ignores the background (LAYOUT_SEPARATE).
  ///
  /// Throws Error(bad_input) for views that do not exist or differ in size, for a target that cannot be drawn
  /// into, and as layout_size() and lay_out() do.
  void draw(const render::Frame& frame, std::size_t first, int layout, const Target& target,
            const Background& background = glm::vec3(0.0f)) {
    draw(frame.colours(), frame.views(), first, layout, target,
         {background, !frame.plan().meshes.depths.empty()});
  }

  /// The same for other pictures, stored as Frame::colours() stores them.
  void draw(const gl::Buffer& colours, std::span<const shared::View> views, std::size_t first, int layout,
            const Target& target, const Backdrop& backdrop);

  /// Compiles the program of draw() for this frame, and if `with_depths`, the programs of draw_depth().
  void prepare(const render::Frame& frame, bool with_depths);

  /// Returns canvases, one per view, with which a frame's own blend draws into these targets
  /// (LAYOUT_SEPARATE). The targets get the same bits as from draw(), in less time. Returns none for more
  /// than MAX_CANVASES targets, or if a target needs a copy. Throws as draw() does.
  Canvases canvases(std::span<const Target> targets, const Background& background, bool over_target = false);

  /// Fills a whole target with the depths of view `v` of the last frame. The context's state is restored.
  /// Throws Error(bad_input) for a view that does not exist, a frame without depth, a target of another kind,
  /// and near and far planes that enclose no depth range.
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
  // Framebuffers, created at first use: for the caller's textures, and for pictures that are copied later.
  std::uint32_t target_framebuffer_ = 0, scratch_framebuffer_ = 0;
  std::unique_ptr<gl::Texture> scratch_;
  std::uint32_t depth_framebuffer_ = 0, no_vertices_ = 0;
};

}  // namespace binosplat::stereo
