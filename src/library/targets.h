#pragma once
// Whether the caller's textures and framebuffers take what a frame draws, found before anything is drawn.

#include <binosplat/renderer.h>

#include <cstdint>
#include <set>
#include <span>

#include "library/texture_level.h"

namespace binosplat::library {

class Targets {
 public:
  explicit Targets(gl::Context& context);
  ~Targets();
  Targets(const Targets&) = delete;
  Targets& operator=(const Targets&) = delete;

  /// Throws Error(bad_input) for pictures and depths that do not go where they are to. Changes no state, and
  /// takes a few queries by target.
  void check(std::span<const View> views, const Settings& settings);

 private:
  void check_size(const glm::ivec2& size, const Argument& argument) const;
  void check_colour(const Target& target, const glm::ivec2& size, const Argument& argument);
  void check_framebuffer(std::uint32_t framebuffer, const Argument& argument) const;
  void check_attached(const Target& target, const glm::ivec2& size, const Argument& argument) const;
  void check_depth(const DepthTarget& target, const Argument& argument) const;

  gl::Context& context_;
  GLint largest_ = 0;              // px, a side of a texture
  std::uint32_t framebuffer_ = 0;  // made at first use, for textures of formats that are not known yet
  std::set<GLint> drawable_ = {};  // formats that were drawn into, or could have been
};

}  // namespace binosplat::library
