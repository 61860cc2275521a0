#include "gl/state.h"

namespace binosplat::gl {

KeptState::KeptState(const Context& context) : gl_(context.gl()) {
  gl_.GetIntegerv(GL_CURRENT_PROGRAM, &program_);
  gl_.GetIntegerv(GL_SHADER_STORAGE_BUFFER_BINDING, &storage_);
  gl_.GetIntegerv(GL_UNIFORM_BUFFER_BINDING, &uniform_);
  gl_.GetIntegerv(GL_DISPATCH_INDIRECT_BUFFER_BINDING, &indirect_);
  gl_.GetIntegeri_v(GL_IMAGE_BINDING_NAME, 0, &image_.texture);
  gl_.GetIntegeri_v(GL_IMAGE_BINDING_LEVEL, 0, &image_.level);
  gl_.GetIntegeri_v(GL_IMAGE_BINDING_LAYERED, 0, &image_.layered);
  gl_.GetIntegeri_v(GL_IMAGE_BINDING_LAYER, 0, &image_.layer);
  gl_.GetIntegeri_v(GL_IMAGE_BINDING_ACCESS, 0, &image_.access);
  gl_.GetIntegeri_v(GL_IMAGE_BINDING_FORMAT, 0, &image_.format);
  scissors_ = gl_.IsEnabledi(GL_SCISSOR_TEST, 0);
  encodes_ = gl_.IsEnabled(GL_FRAMEBUFFER_SRGB);
  discards_ = gl_.IsEnabled(GL_RASTERIZER_DISCARD);
  const auto bound = [this](GLenum buffer, GLenum start, GLenum size, GLuint i) {
    Range range;
    gl_.GetIntegeri_v(buffer, i, &range.buffer);
    gl_.GetInteger64i_v(start, i, &range.offset);
    gl_.GetInteger64i_v(size, i, &range.size);
    return range;
  };
  uniforms_ = bound(GL_UNIFORM_BUFFER_BINDING, GL_UNIFORM_BUFFER_START, GL_UNIFORM_BUFFER_SIZE, 0);
  for (GLuint i = 0; i < storage_bindings_needed; ++i) {
    storages_[i] = bound(GL_SHADER_STORAGE_BUFFER_BINDING, GL_SHADER_STORAGE_BUFFER_START,
                         GL_SHADER_STORAGE_BUFFER_SIZE, i);
  }
}

void KeptState::set_plain() const {
  gl_.Disablei(GL_SCISSOR_TEST, 0);
  gl_.Disable(GL_FRAMEBUFFER_SRGB);
  gl_.Disable(GL_RASTERIZER_DISCARD);
}

void KeptState::bind(GLenum target, GLuint binding, const Range& kept) const {
  const auto buffer = static_cast<GLuint>(kept.buffer);
  if (kept.size == 0) {
    gl_.BindBufferBase(target, binding, buffer);
  } else {
    gl_.BindBufferRange(target, binding, buffer, kept.offset, kept.size);
  }
}

KeptState::~KeptState() {
  for (GLuint i = 0; i < storage_bindings_needed; ++i) bind(GL_SHADER_STORAGE_BUFFER, i, storages_[i]);
  bind(GL_UNIFORM_BUFFER, 0, uniforms_);
  gl_.BindBuffer(GL_UNIFORM_BUFFER, static_cast<GLuint>(uniform_));
  gl_.BindBuffer(GL_SHADER_STORAGE_BUFFER, static_cast<GLuint>(storage_));
  gl_.BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, static_cast<GLuint>(indirect_));
  gl_.BindImageTexture(0, static_cast<GLuint>(image_.texture), image_.level, image_.layered != 0,
                       image_.layer, static_cast<GLenum>(image_.access), static_cast<GLenum>(image_.format));
  if (scissors_ != GL_FALSE) gl_.Enablei(GL_SCISSOR_TEST, 0);
  if (encodes_ != GL_FALSE) gl_.Enable(GL_FRAMEBUFFER_SRGB);
  if (discards_ != GL_FALSE) gl_.Enable(GL_RASTERIZER_DISCARD);
  gl_.UseProgram(static_cast<GLuint>(program_));
}

KeptUnpacking::KeptUnpacking(const Context& context, std::uint32_t buffer) : gl_(context.gl()) {
  gl_.GetIntegerv(GL_PIXEL_UNPACK_BUFFER_BINDING, &buffer_);
  for (std::size_t k = 0; k < names.size(); ++k) {
    gl_.GetIntegerv(static_cast<GLenum>(names[k]), &values_[k]);
    gl_.PixelStorei(static_cast<GLenum>(names[k]), names[k] == GL_UNPACK_ALIGNMENT ? 4 : 0);
  }
  gl_.BindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer);
}

KeptUnpacking::~KeptUnpacking() {
  for (std::size_t k = 0; k < names.size(); ++k) gl_.PixelStorei(static_cast<GLenum>(names[k]), values_[k]);
  gl_.BindBuffer(GL_PIXEL_UNPACK_BUFFER, static_cast<GLuint>(buffer_));
}

}  // namespace binosplat::gl
