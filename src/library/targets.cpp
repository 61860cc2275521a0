#include "library/targets.h"

#include "base/error.h"
#include "library/conversions.h"
#include "stereo/layout.h"

namespace binosplat::library {

namespace {

GLint attached(const gl::Functions& gl, std::uint32_t framebuffer, GLenum place, GLenum what) {
  GLint value = 0;
  gl.GetNamedFramebufferAttachmentParameteriv(framebuffer, place, what, &value);
  return value;
}

constexpr GLenum places_end = GL_COLOR_ATTACHMENT0 + 8;  // every driver has at least eight attachments

/// The size in px of the object attached at `place`; 0 if it was deleted.
glm::ivec2 size_attached(const gl::Functions& gl, std::uint32_t framebuffer, GLenum place, GLint kind) {
  const auto name =
      static_cast<GLuint>(attached(gl, framebuffer, place, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_NAME));
  glm::ivec2 size(0);
  if (kind == GL_TEXTURE) {
    const GLint level = attached(gl, framebuffer, place, GL_FRAMEBUFFER_ATTACHMENT_TEXTURE_LEVEL);
    gl.GetTextureLevelParameteriv(name, level, GL_TEXTURE_WIDTH, &size.x);
    gl.GetTextureLevelParameteriv(name, level, GL_TEXTURE_HEIGHT, &size.y);
  } else {
    gl.GetNamedRenderbufferParameteriv(name, GL_RENDERBUFFER_WIDTH, &size.x);
    gl.GetNamedRenderbufferParameteriv(name, GL_RENDERBUFFER_HEIGHT, &size.y);
  }
  return gl.GetError() == GL_NO_ERROR ? size : glm::ivec2(0);
}

/// The size in px of both eyes' picture in a layout other than `separate`.
glm::ivec2 size_of_both(std::span<const View> views, int layout, bool has_background) {
  const glm::ivec2 left = views[0].size, right = views[1].size;
  if (left != right) {
    fail("views[1].size: {} x {} px beside {} x {}: layout {} takes two of one size", right.x, right.y,
         left.x, left.y, layout_choices[layout].name);
  }
  if (stereo::mixes_colours(layout) && !has_background) {
    fail("layout {} mixes both eyes' colours and leaves no alpha: give settings.background",
         layout_choices[layout].name);
  }
  return stereo::layout_size(layout, left);
}

}  // namespace

Targets::Targets(gl::Context& context) : context_(context) {
  context_.gl().GetIntegerv(GL_MAX_TEXTURE_SIZE, &largest_);
}

Targets::~Targets() { context_.gl().DeleteFramebuffers(1, &framebuffer_); }

void Targets::check(std::span<const View> views, const Settings& settings) {
  for (std::size_t k = 0; k < views.size(); ++k) check_size(views[k].size, {k, "size"});
  const int layout = layout_of(settings.layout);
  if (layout == LAYOUT_SEPARATE) {
    for (std::size_t k = 0; k < views.size(); ++k)
      check_colour(views[k].target, views[k].size, {k, "target"});
  } else {
    const glm::ivec2 both = size_of_both(views, layout, settings.background.has_value());
    check_size(both, {0, "target"});
    check_colour(views[0].target, both, {0, "target"});
  }
  for (std::size_t k = 0; k < views.size(); ++k) {
    const auto& depth = views[k].depth;
    if (!depth) continue;
    check_depth(*depth, {k, "depth"});
    const Place written = {depth->texture, depth->level, depth->layer};
    for (const View& view : views) {
      const auto& mesh = view.mesh_depth;
      if (mesh && Place{mesh->texture, mesh->level, mesh->layer} == written)
        fail("{}: texture {} is a mesh_depth, too, which is only read: give another one",
             Argument{k, "depth"}.name(), depth->texture);
    }
  }
}

void Targets::check_size(const glm::ivec2& size, const Argument& argument) const {
  if (size.x < 1 || size.y < 1 || size.x > largest_ || size.y > largest_)
    fail("{}: {} x {} px: expected sides from 1 to {} px", argument.name(), size.x, size.y, largest_);
}

void Targets::check_colour(const Target& target, const glm::ivec2& size, const Argument& argument) {
  if (target.texture == 0) {
    check_framebuffer(target.framebuffer, argument);
    return check_attached(target, size, argument);
  }
  if (target.framebuffer != 0) {
    fail("{}: texture {} and framebuffer {}: expected one of them", argument.name(), target.texture,
         target.framebuffer);
  }
  const TextureLevel level = texture_level(context_, {target.texture, target.level, target.layer}, argument);
  check_within(level.size, {target.x, target.y}, size, argument);
  // Mutable storage may be incomplete even in a drawable format, so it is always tested.
  if (level.immutable && drawable_.contains(level.format)) return;
  const gl::Functions& gl = context_.gl();
  if (framebuffer_ == 0) gl.CreateFramebuffers(1, &framebuffer_);
  if (target.layer < 0) {
    gl.NamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, target.texture, target.level);
  } else {
    gl.NamedFramebufferTextureLayer(framebuffer_, GL_COLOR_ATTACHMENT0, target.texture, target.level,
                                    target.layer);
  }
  const GLenum status = gl.CheckNamedFramebufferStatus(framebuffer_, GL_DRAW_FRAMEBUFFER);
  const GLint type =
      attached(gl, framebuffer_, GL_COLOR_ATTACHMENT0, GL_FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE);
  const GLenum error = gl.GetError();
  gl.NamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, 0, 0);
  if (error != GL_NO_ERROR || status != GL_FRAMEBUFFER_COMPLETE || type == GL_INT ||
      type == GL_UNSIGNED_INT) {
    fail(
        "{}: texture {} of format 0x{:04x} cannot be drawn into (status 0x{:04x}): expected a "
        "colour-renderable "
        "format, not of integers, and complete levels",
        argument.name(), target.texture, level.format, status);
  }
  drawable_.insert(level.format);
}

void Targets::check_framebuffer(std::uint32_t framebuffer, const Argument& argument) const {
  const gl::Functions& gl = context_.gl();
  const GLenum status = gl.CheckNamedFramebufferStatus(framebuffer, GL_DRAW_FRAMEBUFFER);
  if (gl.GetError() != GL_NO_ERROR)
    fail("{}: there is no framebuffer {} in the context", argument.name(), framebuffer);
  if (framebuffer == 0 && status == GL_FRAMEBUFFER_UNDEFINED)
    fail("{}: the context has no default framebuffer: give a texture or a framebuffer", argument.name());
  if (status != GL_FRAMEBUFFER_COMPLETE) {
    fail("{}: framebuffer {} is not complete (status 0x{:04x}): expected one that can be drawn into",
         argument.name(), framebuffer, status);
  }
  GLint samples = 0;
  gl.GetNamedFramebufferParameteriv(framebuffer, GL_SAMPLES, &samples);
  gl.GetError();  // discards the error of drivers that report no samples of the default framebuffer
  if (samples > 0) {
    fail(
        "{}: framebuffer {} has {} samples a pixel: expected one without multisampling, such as the one that "
        "samples are resolved into",
        argument.name(), framebuffer, samples);
  }
}

// Checks the sizes of all colour attachments. OpenGL does not report the default framebuffer's size.
void Targets::check_attached(const Target& target, const glm::ivec2& size, const Argument& argument) const {
  const std::uint32_t framebuffer = target.framebuffer;
  const gl::Functions& gl = context_.gl();
  bool has_colours = framebuffer == 0;
  if (framebuffer == 0 && (target.x < 0 || target.y < 0))
    fail("{}: its corner at {}, {}: expected zero or more", argument.name(), target.x, target.y);
  for (GLenum place = GL_COLOR_ATTACHMENT0; framebuffer != 0 && place < places_end; ++place) {
    const GLint kind = attached(gl, framebuffer, place, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE);
    if (kind == GL_NONE) continue;
    has_colours = true;
    const glm::ivec2 there = size_attached(gl, framebuffer, place, kind);
    if (there.x == 0) fail("{}: an attachment of framebuffer {} was deleted", argument.name(), framebuffer);
    check_within(there, {target.x, target.y}, size, argument);
    const GLint type = attached(gl, framebuffer, place, GL_FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE);
    if (type == GL_INT || type == GL_UNSIGNED_INT)
      fail("{}: framebuffer {} has an integer format: expected a colour format", argument.name(),
           framebuffer);
  }
  if (!has_colours) fail("{}: framebuffer {} has no colours", argument.name(), framebuffer);
}

void Targets::check_depth(const DepthTarget& target, const Argument& argument) const {
  check_planes(target.near_plane, target.far_plane, argument);
  const TextureLevel level = texture_level(context_, {target.texture, target.level, target.layer}, argument);
  const auto bits = [&](GLenum what) {
    GLint value = 0;
    context_.gl().GetTextureLevelParameteriv(target.texture, target.level, what, &value);
    return value;
  };
  if (bits(GL_TEXTURE_DEPTH_SIZE) == 0 || bits(GL_TEXTURE_STENCIL_SIZE) != 0) {
    fail(
        "{}: texture {} has format 0x{:04x}: expected one of depths without stencil, such as "
        "GL_DEPTH_COMPONENT32F, 24 or 16",
        argument.name(), target.texture, level.format);
  }
}

}  // namespace binosplat::library
