#pragma once
// The state of a context that drawing changes: for those who draw in a context that is not theirs alone.

#include <array>
#include <cstdint>
#include <vector>

#include "gl/context.h"

namespace binosplat::gl {

/// Remembers all state that a frame, and pictures written into a texture or framebuffer, change, and sets it
/// again when it goes: the program; storage and uniform buffers, those of the first storage_bindings_needed
/// bindings, of binding 0 and the general ones; the buffer of indirect dispatches; the image of unit 0; the
/// scissor test of index 0, the conversion to sRGB and the rasterizer's discarding.
///
/// What fills textures from memory is kept by KeptUnpacking where it is needed.
/// Nothing else is touched: nothing is bound to draw with (vertex arrays, framebuffers, textures, samplers),
/// and neither are other images, pixel store, clear values, viewports, masks, tests, blending or the debug
/// callback. Not to be used within transform feedback or conditional rendering; queries that are active count
/// what is done here.
class KeptState {
 public:
  explicit KeptState(const Context& context);
  ~KeptState();
  KeptState(const KeptState&) = delete;
  KeptState& operator=(const KeptState&) = delete;

  /// What a copy reaches a framebuffer whole and unchanged with: no scissors, no conversion to sRGB, nothing
  /// discarded (NVIDIA's driver discards copies, too).
  void set_plain() const;

 private:
  struct Range {
    GLint buffer = 0;
    std::int64_t offset = 0, size = 0;  // bytes; size 0: the whole buffer
  };
  struct Image {
    GLint texture = 0, level = 0, layered = 0, layer = 0, access = 0, format = 0;
  };

  void bind(GLenum target, GLuint binding, const Range& kept) const;

  const Functions& gl_;
  GLint program_ = 0, storage_ = 0, uniform_ = 0, indirect_ = 0;
  Image image_;
  GLboolean scissors_ = 0, encodes_ = 0, discards_ = 0;
  std::array<Range, storage_bindings_needed> storages_;
  Range uniforms_;
};

/// Remembers how textures are filled from memory, sets it to rows that follow one another in a buffer, and
/// sets it again when it goes.
class KeptUnpacking {
 public:
  KeptUnpacking(const Context& context, std::uint32_t buffer);
  ~KeptUnpacking();
  KeptUnpacking(const KeptUnpacking&) = delete;
  KeptUnpacking& operator=(const KeptUnpacking&) = delete;

 private:
  static constexpr std::array names = {GL_UNPACK_SWAP_BYTES, GL_UNPACK_LSB_FIRST,   GL_UNPACK_ROW_LENGTH,
                                       GL_UNPACK_SKIP_ROWS,  GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_IMAGES,
                                       GL_UNPACK_ALIGNMENT,  GL_UNPACK_IMAGE_HEIGHT};

  const Functions& gl_;
  GLint buffer_ = 0;
  std::array<GLint, names.size()> values_{};
};

}  // namespace binosplat::gl
