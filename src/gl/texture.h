#pragma once
// Textures on the GPU.

#include <cstdint>

#include "gl/context.h"

namespace binosplat::gl {

/// A 2D texture of one level. It has storage, or is a view of a level and layer of another texture. A view's
/// format must have as many bits per pixel as the other texture's.
class Texture {
 public:
  Texture(Context& context, GLenum format, int width, int height);
  Texture(Context& context, GLenum format, std::uint32_t viewed, int level, int layer);
  ~Texture();
  Texture(const Texture&) = delete;
  Texture& operator=(const Texture&) = delete;

  bool is(GLenum format, int width, int height) const {
    return format_ == format && width_ == width && height_ == height;
  }
  std::uint32_t id() const { return id_; }
  GLenum format() const { return format_; }

 private:
  void check();

  Context& context_;
  GLenum format_;
  int width_ = 0, height_ = 0;
  std::uint32_t id_ = 0;
};

/// A sampler that reads texels unchanged. It overrides a texture's filter and depth comparison.
class Sampler {
 public:
  explicit Sampler(Context& context);
  ~Sampler();
  Sampler(const Sampler&) = delete;
  Sampler& operator=(const Sampler&) = delete;

  void bind(GLuint unit, std::uint32_t texture) const;

 private:
  Context& context_;
  std::uint32_t id_ = 0;
};

}  // namespace binosplat::gl
