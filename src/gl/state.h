#pragma once
// The state of a context that drawing changes: for those who draw in a context that is not theirs alone.

#include <array>
#include <cstdint>
#include <vector>

#include "gl/context.h"

namespace binosplat::gl {

/// Remembers all state that a frame, and pictures drawn into a framebuffer, change, and sets it again when it
/// goes: the program; the vertex array; the framebuffer drawn into; storage buffers, those of the first
/// storage_blocks_needed bindings and the general one; the buffer of indirect dispatches; viewport, colour
/// mask, scissor test and blending of index 0; clip control; polygon mode; and the tests and effects of
/// set_plain().
///
/// Nothing else is touched: no textures, samplers, images, uniform buffers, pixel store, clear values, read
/// framebuffer, other indexed viewports, debug callback. Not to be used within transform feedback or
/// conditional rendering; queries that are active count what is drawn here.
class KeptState {
 public:
  explicit KeptState(const Context& context);
  ~KeptState();
  KeptState(const KeptState&) = delete;
  KeptState& operator=(const KeptState&) = delete;

  /// What a fragment shader's colours reach the framebuffer unchanged with: no scissors, blending, logic
  /// operation, tests of depth and stencil, culling, clipping, sample masks, dithering or conversion to sRGB;
  /// all of the colour mask; y upwards; filled polygons.
  void set_plain() const;

 private:
  struct Storage {
    GLint buffer = 0;
    std::int64_t offset = 0, size = 0;  // bytes; size 0: the whole buffer
  };

  const Functions& gl_;
  GLint program_ = 0, vertices_ = 0, framebuffer_ = 0, storage_ = 0, indirect_ = 0;
  GLint clip_origin_ = 0, clip_depth_ = 0;
  std::array<GLint, 2> polygon_mode_{};
  std::array<GLfloat, 4> viewport_{};
  std::array<GLboolean, 4> colour_mask_{};
  GLboolean scissors_ = 0, blends_ = 0;
  std::vector<GLboolean> enabled_;
  std::vector<Storage> storages_;
};

}  // namespace binosplat::gl
