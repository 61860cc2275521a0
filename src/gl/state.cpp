#include "gl/state.h"

namespace binosplat::gl {

namespace {

// What set_plain() turns off, the same for all viewports and draw buffers.
constexpr std::array<GLenum, 20> effects = {
    GL_DEPTH_TEST,          GL_STENCIL_TEST,    GL_CULL_FACE,      GL_RASTERIZER_DISCARD,
    GL_FRAMEBUFFER_SRGB,    GL_COLOR_LOGIC_OP,  GL_DITHER,         GL_SAMPLE_ALPHA_TO_COVERAGE,
    GL_SAMPLE_ALPHA_TO_ONE, GL_SAMPLE_COVERAGE, GL_SAMPLE_MASK,    GL_POLYGON_SMOOTH,
    GL_CLIP_DISTANCE0,      GL_CLIP_DISTANCE1,  GL_CLIP_DISTANCE2, GL_CLIP_DISTANCE3,
    GL_CLIP_DISTANCE4,      GL_CLIP_DISTANCE5,  GL_CLIP_DISTANCE6, GL_CLIP_DISTANCE7};

void set(const Functions& gl, GLenum effect, bool on) {
  if (on) {
    gl.Enable(effect);
  } else {
    gl.Disable(effect);
  }
}

void set_first(const Functions& gl, GLenum effect, bool on) {
  if (on) {
    gl.Enablei(effect, 0);
  } else {
    gl.Disablei(effect, 0);
  }
}

}  // namespace

KeptState::KeptState(const Context& context) : gl_(context.gl()) {
  gl_.GetIntegerv(GL_CURRENT_PROGRAM, &program_);
  gl_.GetIntegerv(GL_VERTEX_ARRAY_BINDING, &vertices_);
  gl_.GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer_);
  gl_.GetIntegerv(GL_SHADER_STORAGE_BUFFER_BINDING, &storage_);
  gl_.GetIntegerv(GL_DISPATCH_INDIRECT_BUFFER_BINDING, &indirect_);
  gl_.GetIntegerv(GL_CLIP_ORIGIN, &clip_origin_);
  gl_.GetIntegerv(GL_CLIP_DEPTH_MODE, &clip_depth_);
  gl_.GetIntegerv(GL_POLYGON_MODE, polygon_mode_.data());
  gl_.GetFloati_v(GL_VIEWPORT, 0, viewport_.data());
  gl_.GetBooleani_v(GL_COLOR_WRITEMASK, 0, colour_mask_.data());
  scissors_ = gl_.IsEnabledi(GL_SCISSOR_TEST, 0);
  blends_ = gl_.IsEnabledi(GL_BLEND, 0);
  for (const GLenum effect : effects) enabled_.push_back(gl_.IsEnabled(effect));
  storages_.resize(storage_blocks_needed);
  for (GLuint i = 0; i < storage_blocks_needed; ++i) {
    gl_.GetIntegeri_v(GL_SHADER_STORAGE_BUFFER_BINDING, i, &storages_[i].buffer);
    gl_.GetInteger64i_v(GL_SHADER_STORAGE_BUFFER_START, i, &storages_[i].offset);
    gl_.GetInteger64i_v(GL_SHADER_STORAGE_BUFFER_SIZE, i, &storages_[i].size);
  }
}

void KeptState::set_plain() const {
  for (const GLenum effect : effects) gl_.Disable(effect);
  gl_.Disablei(GL_SCISSOR_TEST, 0);
  gl_.Disablei(GL_BLEND, 0);
  gl_.ColorMaski(0, GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl_.ClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
  gl_.PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

KeptState::~KeptState() {
  for (GLuint i = 0; i < storages_.size(); ++i) {
    const Storage& kept = storages_[i];
    const auto buffer = static_cast<GLuint>(kept.buffer);
    if (kept.size == 0) {
      gl_.BindBufferBase(GL_SHADER_STORAGE_BUFFER, i, buffer);
    } else {
      gl_.BindBufferRange(GL_SHADER_STORAGE_BUFFER, i, buffer, kept.offset, kept.size);
    }
  }
  gl_.BindBuffer(GL_SHADER_STORAGE_BUFFER, static_cast<GLuint>(storage_));
  gl_.BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, static_cast<GLuint>(indirect_));
  for (std::size_t i = 0; i < effects.size(); ++i) set(gl_, effects[i], enabled_[i] != GL_FALSE);
  set_first(gl_, GL_SCISSOR_TEST, scissors_ != GL_FALSE);
  set_first(gl_, GL_BLEND, blends_ != GL_FALSE);
  gl_.ColorMaski(0, colour_mask_[0], colour_mask_[1], colour_mask_[2], colour_mask_[3]);
  gl_.ClipControl(static_cast<GLenum>(clip_origin_), static_cast<GLenum>(clip_depth_));
  gl_.PolygonMode(GL_FRONT_AND_BACK, static_cast<GLenum>(polygon_mode_[0]));
  gl_.ViewportIndexedfv(0, viewport_.data());
  gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(framebuffer_));
  gl_.BindVertexArray(static_cast<GLuint>(vertices_));
  gl_.UseProgram(static_cast<GLuint>(program_));
}

}  // namespace binosplat::gl
