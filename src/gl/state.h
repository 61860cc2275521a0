#pragma once
// Saves and restores the GL state that drawing changes, for contexts that the caller also uses.

#include <array>
#include <cstdint>

#include "gl/context.h"
#include "shared/limits.h"

namespace binosplat::gl {

/// Saves the state that binosplat changes when it draws a frame or writes a picture into a texture or
/// framebuffer; restores it when destroyed. The state is: the current program; the first
/// storage_bindings_needed indexed storage bindings, uniform binding 0 and both generic buffer bindings; the
/// buffer of indirect dispatches; the images of the first MAX_CANVASES units; the scissor test of index 0,
/// GL_FRAMEBUFFER_SRGB, GL_RASTERIZER_DISCARD. A current program marked for deletion is not restored.
///
/// Frames and pictures change no other state. To draw triangles, also use SavedDrawing. Do not draw
/// within transform feedback or conditional rendering. Active queries also count binosplat's work.
class SavedState {
 public:
  explicit SavedState(const Context& context);
  ~SavedState();
  SavedState(const SavedState&) = delete;
  SavedState& operator=(const SavedState&) = delete;

  /// Sets the state in which a copy writes all pixels of a framebuffer, with unchanged values: no scissor
  /// test, no conversion to sRGB, no rasterizer discard (on NVIDIA's driver it also discards copies).
  void set_plain() const;

 private:
  struct Range {
    GLint buffer = 0;
    std::int64_t offset = 0, size = 0;  // bytes; a size of 0 means the whole buffer
  };
  struct Image {
    GLint texture = 0, level = 0, layered = 0, layer = 0, access = 0, format = 0;
  };

  void bind(GLenum target, GLuint binding, const Range& kept) const;

  const Functions& gl_;
  GLint program_ = 0, storage_ = 0, uniform_ = 0, indirect_ = 0;
  std::array<Image, MAX_CANVASES> images_;
  GLboolean scissors_ = 0, encodes_ = 0, discards_ = 0;
  std::array<Range, storage_bindings_needed> storages_;
  Range uniforms_;
};

/// Saves the 2D textures and samplers of the first 2 * MAX_CANVASES units, to which a frame with mesh depths
/// binds the caller's textures; restores them when destroyed. Use it together with a SavedState.
class SavedTextures {
 public:
  explicit SavedTextures(const Context& context);
  ~SavedTextures();
  SavedTextures(const SavedTextures&) = delete;
  SavedTextures& operator=(const SavedTextures&) = delete;

 private:
  struct Unit {
    GLint texture = 0, sampler = 0;
  };

  const Functions& gl_;
  GLint active_ = 0;
  std::array<Unit, std::size_t{2} * MAX_CANVASES> units_;
};

/// Sets the state in which a triangle writes every pixel of a depth texture; restores the previous state when
/// destroyed. The state is the draw framebuffer, the vertex array, viewport 0, clip control, polygon mode,
/// depth and stencil tests, face culling and clip distances. Use it together with a SavedState.
class SavedDrawing {
 public:
  SavedDrawing(const Context& context, std::uint32_t framebuffer, std::uint32_t vertices, int width,
               int height);
  ~SavedDrawing();
  SavedDrawing(const SavedDrawing&) = delete;
  SavedDrawing& operator=(const SavedDrawing&) = delete;

 private:
  static constexpr std::array tests = {GL_DEPTH_TEST,     GL_DEPTH_CLAMP,    GL_STENCIL_TEST,
                                       GL_CULL_FACE,      GL_CLIP_DISTANCE0, GL_CLIP_DISTANCE1,
                                       GL_CLIP_DISTANCE2, GL_CLIP_DISTANCE3, GL_CLIP_DISTANCE4,
                                       GL_CLIP_DISTANCE5, GL_CLIP_DISTANCE6, GL_CLIP_DISTANCE7};

  const Functions& gl_;
  GLint framebuffer_ = 0, vertices_ = 0, function_ = 0, mask_ = 0, origin_ = 0, clip_depth_ = 0;
  std::array<GLint, 2> polygons_{};
  std::array<GLfloat, 4> viewport_{};
  std::array<GLboolean, tests.size()> enabled_{};
};

}  // namespace binosplat::gl
