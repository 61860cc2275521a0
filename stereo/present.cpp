#include "stereo/present.h"

#include <bit>

#include "base/error.h"
#include "gl/state.h"
#include "stereo/layout.h"

namespace binosplat::stereo {

Presenter::~Presenter() {
  if (framebuffer_ != 0) dispatcher_.context().gl().DeleteFramebuffers(1, &framebuffer_);
}

void Presenter::bind(const Target& target) {
  const gl::Functions& gl = dispatcher_.context().gl();
  if (target.texture == 0) {
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, target.framebuffer);
    return;
  }
  if (framebuffer_ == 0) gl.CreateFramebuffers(1, &framebuffer_);
  if (target.layer < 0) {
    gl.NamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, target.texture, target.level);
  } else {
    gl.NamedFramebufferTextureLayer(framebuffer_, GL_COLOR_ATTACHMENT0, target.texture, target.level,
                                    target.layer);
  }
  const GLenum error = gl.GetError();
  const GLenum status = gl.CheckNamedFramebufferStatus(framebuffer_, GL_DRAW_FRAMEBUFFER);
  if (error != GL_NO_ERROR || status != GL_FRAMEBUFFER_COMPLETE) {
    fail(
        "texture {}, level {}, layer {} cannot be drawn into (OpenGL error 0x{:04x}, status 0x{:04x}): "
        "expected a "
        "2D texture, or a layer of an array, of a colour-renderable format",
        target.texture, target.level, target.layer, error, status);
  }
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_);
}

void Presenter::draw(const gl::Buffer& colours, std::span<const shared::View> views, std::size_t first,
                     int layout, const Target& target, const Background& background) {
  const std::size_t second = layout == LAYOUT_SEPARATE ? first : first + 1;
  if (second >= views.size()) fail("view {} of a frame of {} views", second, views.size());
  const shared::View &left = views[first], &right = views[second];
  if (left.width != right.width || left.height != right.height) {
    fail("layout {}: the eyes differ in size, {} x {} and {} x {} px", layout_choices[layout].name,
         left.width, left.height, right.width, right.height);
  }
  if (layout == LAYOUT_MULTI_VIEW) fail("layout multi-view is for OpenEXR files");
  if (layout == LAYOUT_QUAD_BUFFER)
    fail("layout quad-buffer is two framebuffers: draw each view by itself (separate) into its own");
  if (mixes_colours(layout) && !background) {
    fail("layout {} mixes both eyes' colours and leaves no alpha: give a background",
         layout_choices[layout].name);
  }
  const glm::ivec2 size = layout_size(layout, {static_cast<int>(left.width), static_cast<int>(left.height)});
  const glm::vec3 behind = background.value_or(glm::vec3(0.0f));
  const gl::KeptState kept(dispatcher_.context());
  kept.set_plain();
  bind(target);
  dispatcher_.context().gl().ViewportIndexedf(0, static_cast<float>(target.x), static_cast<float>(target.y),
                                              static_cast<float>(size.x), static_cast<float>(size.y));
  dispatcher_.fill(dispatcher_.context().program("present.frag"), {{"Colours", colours}},
                   {{"kind", static_cast<std::uint32_t>(layout)},
                    {"first", left.pixel_offset},
                    {"second", right.pixel_offset},
                    {"width", left.width},
                    {"height", left.height},
                    {"left", static_cast<std::uint32_t>(target.x)},
                    {"bottom", static_cast<std::uint32_t>(target.y)},
                    {"rows", static_cast<std::uint32_t>(size.y)},
                    {"background_r", std::bit_cast<std::uint32_t>(behind.r)},
                    {"background_g", std::bit_cast<std::uint32_t>(behind.g)},
                    {"background_b", std::bit_cast<std::uint32_t>(behind.b)},
                    {"keeps_alpha", background ? 0u : 1u}});
  // What is the caller's to delete is not held on to.
  if (target.texture != 0)
    dispatcher_.context().gl().NamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, 0, 0);
}

}  // namespace binosplat::stereo
