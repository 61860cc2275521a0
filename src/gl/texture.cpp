#include "gl/texture.h"

namespace binosplat::gl {

Texture::Texture(Context& context, GLenum format, int width, int height)
    : context_(context), format_(format), width_(width), height_(height) {
  context_.gl().CreateTextures(GL_TEXTURE_2D, 1, &id_);
  context_.gl().TextureStorage2D(id_, 1, format, width, height);
  check();
}

Texture::Texture(Context& context, GLenum format, std::uint32_t viewed, int level, int layer)
    : context_(context), format_(format) {
  context_.gl().GenTextures(1, &id_);
  context_.gl().TextureView(id_, GL_TEXTURE_2D, viewed, format, static_cast<GLuint>(level), 1,
                            static_cast<GLuint>(layer), 1);
  check();
}

Texture::~Texture() { context_.gl().DeleteTextures(1, &id_); }

void Texture::check() {
  try {
    context_.check("a texture");
  } catch (...) {
    context_.gl().DeleteTextures(1, &id_);
    throw;
  }
}

Sampler::Sampler(Context& context) : context_(context) {
  context_.gl().CreateSamplers(1, &id_);
  context_.gl().SamplerParameteri(id_, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  context_.gl().SamplerParameteri(id_, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

void Sampler::bind(GLuint unit, std::uint32_t texture) const {
  context_.gl().BindTextureUnit(unit, texture);
  context_.gl().BindSampler(unit, id_);
}

Sampler::~Sampler() { context_.gl().DeleteSamplers(1, &id_); }

}  // namespace binosplat::gl
