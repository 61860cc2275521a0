#include "gl/state.h"

namespace binosplat::gl {

SavedState::SavedState(const Context& context) : gl_(context.gl()) {
  gl_.GetIntegerv(GL_CURRENT_PROGRAM, &program_);
  gl_.GetIntegerv(GL_SHADER_STORAGE_BUFFER_BINDING, &storage_);
  gl_.GetIntegerv(GL_UNIFORM_BUFFER_BINDING, &uniform_);
  gl_.GetIntegerv(GL_DISPATCH_INDIRECT_BUFFER_BINDING, &indirect_);
  for (GLuint unit = 0; unit < images_.size(); ++unit) {
    Image& image = images_[unit];
    gl_.GetIntegeri_v(GL_IMAGE_BINDING_NAME, unit, &image.texture);
    gl_.GetIntegeri_v(GL_IMAGE_BINDING_LEVEL, unit, &image.level);
    gl_.GetIntegeri_v(GL_IMAGE_BINDING_LAYERED, unit, &image.layered);
    gl_.GetIntegeri_v(GL_IMAGE_BINDING_LAYER, unit, &image.layer);
    gl_.GetIntegeri_v(GL_IMAGE_BINDING_ACCESS, unit, &image.access);
    gl_.GetIntegeri_v(GL_IMAGE_BINDING_FORMAT, unit, &image.format);
  }
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

void SavedState::set_plain() const {
  gl_.Disablei(GL_SCISSOR_TEST, 0);
  gl_.Disable(GL_FRAMEBUFFER_SRGB);
  gl_.Disable(GL_RASTERIZER_DISCARD);
}

void SavedState::bind(GLenum target, GLuint binding, const Range& kept) const {
  const auto buffer = static_cast<GLuint>(kept.buffer);
  if (kept.size == 0) {
    gl_.BindBufferBase(target, binding, buffer);
  } else {
    gl_.BindBufferRange(target, binding, buffer, kept.offset, kept.size);
  }
}

SavedState::~SavedState() {
  for (GLuint i = 0; i < storage_bindings_needed; ++i) bind(GL_SHADER_STORAGE_BUFFER, i, storages_[i]);
  bind(GL_UNIFORM_BUFFER, 0, uniforms_);
  gl_.BindBuffer(GL_UNIFORM_BUFFER, static_cast<GLuint>(uniform_));
  gl_.BindBuffer(GL_SHADER_STORAGE_BUFFER, static_cast<GLuint>(storage_));
  gl_.BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, static_cast<GLuint>(indirect_));
  for (GLuint unit = 0; unit < images_.size(); ++unit) {
    const Image& image = images_[unit];
    gl_.BindImageTexture(unit, static_cast<GLuint>(image.texture), image.level, image.layered != 0,
                         image.layer, static_cast<GLenum>(image.access), static_cast<GLenum>(image.format));
  }
  if (scissors_ != GL_FALSE) gl_.Enablei(GL_SCISSOR_TEST, 0);
  if (encodes_ != GL_FALSE) gl_.Enable(GL_FRAMEBUFFER_SRGB);
  if (discards_ != GL_FALSE) gl_.Enable(GL_RASTERIZER_DISCARD);
  // If the saved program was marked for deletion, GL deleted it when another program became current.
  const auto program = static_cast<GLuint>(program_);
  gl_.UseProgram(gl_.IsProgram(program) == GL_TRUE ? program : 0);
}

SavedTextures::SavedTextures(const Context& context) : gl_(context.gl()) {
  gl_.GetIntegerv(GL_ACTIVE_TEXTURE, &active_);
  for (GLuint unit = 0; unit < units_.size(); ++unit) {
    gl_.ActiveTexture(GL_TEXTURE0 + unit);
    gl_.GetIntegerv(GL_TEXTURE_BINDING_2D, &units_[unit].texture);
    gl_.GetIntegerv(GL_SAMPLER_BINDING, &units_[unit].sampler);
  }
  gl_.ActiveTexture(static_cast<GLenum>(active_));
}

SavedTextures::~SavedTextures() {
  for (GLuint unit = 0; unit < units_.size(); ++unit) {
    gl_.ActiveTexture(GL_TEXTURE0 + unit);
    gl_.BindTexture(GL_TEXTURE_2D, static_cast<GLuint>(units_[unit].texture));
    gl_.BindSampler(unit, static_cast<GLuint>(units_[unit].sampler));
  }
  gl_.ActiveTexture(static_cast<GLenum>(active_));
}

SavedDrawing::SavedDrawing(const Context& context, std::uint32_t framebuffer, std::uint32_t vertices,
                           int width, int height)
    : gl_(context.gl()) {
  gl_.GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer_);
  gl_.GetIntegerv(GL_VERTEX_ARRAY_BINDING, &vertices_);
  gl_.GetIntegerv(GL_DEPTH_FUNC, &function_);
  gl_.GetIntegerv(GL_DEPTH_WRITEMASK, &mask_);
  gl_.GetIntegerv(GL_CLIP_ORIGIN, &origin_);
  gl_.GetIntegerv(GL_CLIP_DEPTH_MODE, &clip_depth_);
  gl_.GetIntegerv(GL_POLYGON_MODE, polygons_.data());
  gl_.GetFloati_v(GL_VIEWPORT, 0, viewport_.data());
  for (std::size_t k = 0; k < tests.size(); ++k) {
    const auto test = static_cast<GLenum>(tests[k]);
    enabled_[k] = gl_.IsEnabled(test);
    if (enabled_[k] != GL_FALSE) gl_.Disable(test);
  }
  gl_.Enable(GL_DEPTH_TEST);  // without the test GL writes no depths
  gl_.DepthFunc(GL_ALWAYS);
  gl_.DepthMask(GL_TRUE);
  gl_.ClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
  gl_.PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
  gl_.BindVertexArray(vertices);
  gl_.ViewportIndexedf(0, 0.0f, 0.0f, static_cast<float>(width), static_cast<float>(height));
}

SavedDrawing::~SavedDrawing() {
  gl_.ViewportIndexedf(0, viewport_[0], viewport_[1], viewport_[2], viewport_[3]);
  gl_.BindVertexArray(static_cast<GLuint>(vertices_));
  gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(framebuffer_));
  gl_.PolygonMode(GL_FRONT_AND_BACK, static_cast<GLenum>(polygons_[0]));
  gl_.ClipControl(static_cast<GLenum>(origin_), static_cast<GLenum>(clip_depth_));
  gl_.DepthMask(static_cast<GLboolean>(mask_));
  gl_.DepthFunc(static_cast<GLenum>(function_));
  gl_.Disable(GL_DEPTH_TEST);
  for (std::size_t k = 0; k < tests.size(); ++k) {
    if (enabled_[k] != GL_FALSE) gl_.Enable(static_cast<GLenum>(tests[k]));
  }
}

}  // namespace binosplat::gl
