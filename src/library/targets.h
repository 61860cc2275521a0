#pragma once
// Checks that a frame can be drawn into the caller's textures and framebuffers, before anything is drawn.

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

  /// Throws Error(bad_input) for a picture or a depth that does not fit its target. Changes no state of the
  /// context, and takes a few queries per target.
  void check(std::span<const View> views, const Settings& settings);

 private:
  void check_size(const glm::ivec2& size, const Argument& argument) const;
  void check_colour(const Target& target, const glm::ivec2& size, const Argument& argument);
  void check_framebuffer(std::uint32_t framebuffer, const Argument& argument) const;
  void check_attached(const Target& target, const glm::ivec2& size, const Argument& argument) const;
  void check_depth(const DepthTarget& target, const Argument& argument) const;

  gl::Context& context_;
  GLint largest_ = 0;              // px, the maximum side of a texture
  std::uint32_t framebuffer_ = 0;  // created at first use; tests formats that are not in drawable_
  std::set<GLint> drawable_ = {};  // formats that passed the test
};

}  // namespace binosplat::library
