#pragma once
// Pictures on the GPU.

#include <cstdint>

#include "gl/context.h"

namespace binosplat::gl {

/// A 2D texture of one level: its own, or a view of a level and layer of another as if that were of a format
/// of as many bits a pixel.
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

/// Reads a texel as it is, whatever filters and comparisons its texture asks for.
class Sampler {
 public:
  explicit Sampler(Context& context);
  ~Sampler();
  Sampler(const Sampler&) = delete;
  Sampler& operator=(const Sampler&) = delete;

  /// Has shaders read a 2D texture by it at a unit.
  void bind(GLuint unit, std::uint32_t texture) const;

 private:
  Context& context_;
  std::uint32_t id_ = 0;
};

}  // namespace binosplat::gl
