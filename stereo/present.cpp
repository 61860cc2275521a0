#include "stereo/present.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "gl/state.h"
#include "shared/limits.h"
#include "stereo/layout.h"

namespace binosplat::stereo {

namespace {

/// How a compute shader writes a caller's texture in place; GL_NONE: it cannot.
struct InPlace {
  GLenum format = GL_NONE;
  bool by_view = false;  // through a texture view of `format`
};

/// If a texture is the framebuffer's only colour attachment, returns the texture, else `target`. Writing the
/// texture in place avoids a copy, which is slow on server GPUs.
Target texture_behind(const gl::Functions& gl, const Target& target) {
  if (target.texture != 0 || target.framebuffer == 0) return target;
  const auto attached = [&](GLenum place, GLenum what) {
    GLint value = 0;
    gl.GetNamedFramebufferAttachmentParameteriv(target.framebuffer, place, what, &value);
    return value;
  };
  for (GLenum other = 1; other < 8; ++other) {  // every driver has at least eight attachments
    if (attached(GL_COLOR_ATTACHMENT0 + other, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE) != GL_NONE)
      return target;
  }
  constexpr GLenum first = GL_COLOR_ATTACHMENT0;
  if (attached(first, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE) != GL_TEXTURE ||
      attached(first, GL_FRAMEBUFFER_ATTACHMENT_LAYERED) != 0)
    return target;
  return {.texture = static_cast<std::uint32_t>(attached(first, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_NAME)),
          .level = attached(first, GL_FRAMEBUFFER_ATTACHMENT_TEXTURE_LEVEL),
          .layer = attached(first, GL_FRAMEBUFFER_ATTACHMENT_TEXTURE_LAYER),
          .x = target.x,
          .y = target.y,
          .in_place = target.in_place};
}

// Canvas::keeps_alpha.
std::uint32_t keeps_alpha(const Target& target, const Background& background) {
  if (background) return 0;
  return target.linear_alpha ? 2 : 1;
}

InPlace in_place(const gl::Functions& gl, const Target& target, bool over_target) {
  if (target.texture == 0 || !target.in_place) return {};
  GLint kind = 0, format = 0, immutable = 0, base = 0, top = 0;
  gl.GetTextureParameteriv(target.texture, GL_TEXTURE_BASE_LEVEL, &base);
  gl.GetTextureParameteriv(target.texture, GL_TEXTURE_MAX_LEVEL, &top);
  gl.GetTextureParameteriv(target.texture, GL_TEXTURE_TARGET, &kind);
  gl.GetTextureParameteriv(target.texture, GL_TEXTURE_IMMUTABLE_FORMAT, &immutable);
  gl.GetTextureLevelParameteriv(target.texture, target.level, GL_TEXTURE_INTERNAL_FORMAT, &format);
  if (kind != GL_TEXTURE_2D && kind != GL_TEXTURE_2D_ARRAY) return {};
  // An sRGB texture stores display values as plain bytes, which a texture view of format RGBA8 writes. Only
  // immutable textures have views.
  if (format == GL_SRGB8_ALPHA8 && immutable != 0) return {GL_RGBA8, true};
  constexpr std::array formats = {GL_RGBA8, GL_RGB10_A2, GL_RGBA16, GL_RGBA16F, GL_RGBA32F};
  if (std::find(formats.begin(), formats.end(), format) == formats.end()) return {};
  // A texture that is also read, or a level out of its range, needs a texture view, with usual parameters.
  const bool by_view = over_target || target.level < base || target.level > top;
  if (by_view && immutable == 0) return {};
  return {static_cast<GLenum>(format), by_view};
}

/// The format of a picture that is later copied into a framebuffer. It has at least the framebuffer's bits.
GLenum copied_from(const gl::Functions& gl, GLuint framebuffer) {
  GLenum place = GL_COLOR_ATTACHMENT0;
  if (framebuffer == 0) {
    GLint doubled = 0;
    gl.GetNamedFramebufferParameteriv(0, GL_DOUBLEBUFFER, &doubled);
    place = doubled != 0 ? GL_BACK_LEFT : GL_FRONT_LEFT;
  }
  GLint bits = 0;
  gl.GetNamedFramebufferAttachmentParameteriv(framebuffer, place, GL_FRAMEBUFFER_ATTACHMENT_RED_SIZE, &bits);
  gl.GetError();  // clears the error for a missing attachment; a copy that needs the attachment fails
  return bits > 0 && bits <= 8 ? GL_RGBA8 : GL_RGBA32F;
}

glm::ivec2 size_of(const gl::Functions& gl, const DepthTarget& target) {
  glm::ivec2 size(0);
  gl.GetTextureLevelParameteriv(target.texture, target.level, GL_TEXTURE_WIDTH, &size.x);
  gl.GetTextureLevelParameteriv(target.texture, target.level, GL_TEXTURE_HEIGHT, &size.y);
  gl.GetError();  // clears the error for a missing texture; drawing into the texture reports it
  return size;
}

}  // namespace

Presenter::~Presenter() {
  const std::array framebuffers = {target_framebuffer_, scratch_framebuffer_, depth_framebuffer_};
  dispatcher_.context().gl().DeleteVertexArrays(1, &no_vertices_);
  dispatcher_.context().gl().DeleteFramebuffers(framebuffers.size(), framebuffers.data());
}

// Throws Error unless the texture can be attached.
void Presenter::attach(std::uint32_t framebuffer, GLenum place, std::uint32_t texture, int level, int layer,
                       const char* kind) {
  const gl::Functions& gl = dispatcher_.context().gl();
  if (layer < 0) {
    gl.NamedFramebufferTexture(framebuffer, place, texture, level);
  } else {
    gl.NamedFramebufferTextureLayer(framebuffer, place, texture, level, layer);
  }
  const GLenum error = gl.GetError();
  const GLenum status = gl.CheckNamedFramebufferStatus(framebuffer, GL_DRAW_FRAMEBUFFER);
  if (error == GL_NO_ERROR && status == GL_FRAMEBUFFER_COMPLETE) return;
  gl.NamedFramebufferTexture(framebuffer, place, 0, 0);
  fail(
      "texture {}, level {}, layer {} cannot be drawn into (OpenGL error 0x{:04x}, status 0x{:04x}): "
      "expected a 2D texture, or a layer of an array, of a {}-renderable format",
      texture, level, layer, error, status, kind);
}

std::uint32_t Presenter::framebuffer_of(const Target& target) {
  if (target.texture == 0) return target.framebuffer;
  if (target_framebuffer_ == 0) dispatcher_.context().gl().CreateFramebuffers(1, &target_framebuffer_);
  attach(target_framebuffer_, GL_COLOR_ATTACHMENT0, target.texture, target.level, target.layer, "colour");
  return target_framebuffer_;
}

void Presenter::copy(const glm::ivec2& size, std::uint32_t to, const glm::ivec2& corner) {
  const gl::Functions& gl = dispatcher_.context().gl();
  gl.BlitNamedFramebuffer(scratch_framebuffer_, to, 0, 0, size.x, size.y, corner.x, corner.y,
                          corner.x + size.x, corner.y + size.y, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  const GLenum error = gl.GetError();
  if (error != GL_NO_ERROR) {
    fail(
        "framebuffer {} cannot be drawn into (OpenGL error 0x{:04x}): expected a complete framebuffer with "
        "colours",
        to, error);
  }
}

// Copies a framebuffer's content to the scratch texture.
void Presenter::copy_back(const glm::ivec2& size, std::uint32_t from, const glm::ivec2& corner) {
  const gl::Functions& gl = dispatcher_.context().gl();
  gl.BlitNamedFramebuffer(from, scratch_framebuffer_, corner.x, corner.y, corner.x + size.x,
                          corner.y + size.y, 0, 0, size.x, size.y, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  const GLenum error = gl.GetError();
  if (error != GL_NO_ERROR) {
    fail(
        "framebuffer {} cannot be read (OpenGL error 0x{:04x}): expected a complete framebuffer with "
        "colours, without samples",
        from, error);
  }
}

const gl::Texture& Presenter::scratch(const glm::ivec2& size, GLenum format) {
  const gl::Functions& gl = dispatcher_.context().gl();
  if (scratch_ != nullptr && scratch_->is(format, size.x, size.y)) return *scratch_;
  scratch_.reset();  // frees its memory first
  scratch_ = std::make_unique<gl::Texture>(dispatcher_.context(), format, size.x, size.y);
  if (scratch_framebuffer_ == 0) gl.CreateFramebuffers(1, &scratch_framebuffer_);
  gl.NamedFramebufferTexture(scratch_framebuffer_, GL_COLOR_ATTACHMENT0, scratch_->id(), 0);
  return *scratch_;
}

void Presenter::draw(const gl::Buffer& colours, std::span<const shared::View> views, std::size_t first,
                     int layout, const Target& target, const Backdrop& backdrop) {
  const Background& background = backdrop.background;
  const bool over_target = backdrop.is_in_target;
  if (over_target && layout != LAYOUT_SEPARATE)
    fail("layout {} over the target's content: expected separate", layout_choices[layout].name);
  const std::size_t second = layout == LAYOUT_SEPARATE ? first : first + 1;
  if (second >= views.size()) fail("view {} of a frame of {} views", second, views.size());
  const shared::View &left = views[first], &right = views[second];
  if (left.width != right.width || left.height != right.height) {
    fail("layout {}: the eyes differ in size, {} x {} and {} x {} px", layout_choices[layout].name,
         left.width, left.height, right.width, right.height);
  }
  if (layout == LAYOUT_MULTI_VIEW) fail("layout multi-view is for OpenEXR files");
  if (layout == LAYOUT_QUAD_BUFFER)
    fail("layout quad-buffer needs two framebuffers: draw each view into its own, with layout separate");
  if (mixes_colours(layout) && !background) {
    fail("layout {} mixes both eyes' colours and leaves no alpha: give a background",
         layout_choices[layout].name);
  }
  const glm::ivec2 size = layout_size(layout, {static_cast<int>(left.width), static_cast<int>(left.height)});
  const glm::uvec2 groups = (glm::uvec2(size) + glm::uvec2(PRESENT_COLUMNS, PRESENT_ROWS) - 1u) /
                            glm::uvec2(PRESENT_COLUMNS, PRESENT_ROWS);
  const glm::vec3 behind = background.value_or(glm::vec3(0.0f));
  gl::Context& context = dispatcher_.context();
  const gl::SavedState saved(context);
  saved.set_plain();
  std::optional<gl::SavedTextures> textures;
  if (over_target) textures.emplace(context);
  const auto write = [&](const Target& image, GLenum format) {
    context.gl().BindImageTexture(0, image.texture, image.level, GL_FALSE, std::max(image.layer, 0),
                                  GL_WRITE_ONLY, format);
    if (over_target) nearest_.bind(0, image.texture);
    dispatcher_.start(context.program("present.comp", gl::Number{"OVER", over_target, 2}),
                      gl::DispatchSize::of_groups(std::uint64_t{groups.x} * groups.y), {{"Colours", colours}},
                      {{"kind", static_cast<std::uint32_t>(layout)},
                       {"first", left.pixel_offset},
                       {"second", right.pixel_offset},
                       {"width", left.width},
                       {"height", left.height},
                       {"columns", static_cast<std::uint32_t>(size.x)},
                       {"rows", static_cast<std::uint32_t>(size.y)},
                       {"left", static_cast<std::uint32_t>(image.x)},
                       {"bottom", static_cast<std::uint32_t>(image.y)},
                       {"background_r", std::bit_cast<std::uint32_t>(behind.r)},
                       {"background_g", std::bit_cast<std::uint32_t>(behind.g)},
                       {"background_b", std::bit_cast<std::uint32_t>(behind.b)},
                       {"keeps_alpha", keeps_alpha(target, background)},
                       {"linear", target.linear ? 1u : 0u},
                       {"steps", render::steps_of(format)}});
    context.gl().MemoryBarrier(GL_ALL_BARRIER_BITS);  // before any use of the picture
  };
  const std::uint32_t framebuffer = framebuffer_of(target);
  const Target texture = texture_behind(context.gl(), target);
  const auto [format, by_view] = in_place(context.gl(), texture, over_target);
  if (format == GL_NONE) {
    const gl::Texture& picture = scratch(size, copied_from(context.gl(), framebuffer));
    if (over_target) copy_back(size, framebuffer, {target.x, target.y});
    write({.texture = picture.id()}, picture.format());
    copy(size, framebuffer, {target.x, target.y});
  } else if (by_view) {
    const gl::Texture view(context, format, texture.texture, texture.level, std::max(texture.layer, 0));
    write({.texture = view.id(), .x = target.x, .y = target.y}, format);
  } else {
    write(texture, format);
  }
  // Detaches the caller's texture, which the caller may delete.
  if (target.texture != 0)
    context.gl().NamedFramebufferTexture(target_framebuffer_, GL_COLOR_ATTACHMENT0, 0, 0);
}

void Presenter::prepare(const render::Frame& frame, bool with_depths) {
  gl::Context& context = dispatcher_.context();
  context.prepare([&] {
    context.program("present.comp", gl::Number{"OVER", !frame.plan().meshes.depths.empty(), 2});
    for (const std::uint32_t is_depth : {0u, 1u})
      if (with_depths) context.program("present_depth.frag", gl::Number{"IS_DEPTH", is_depth, 2});
  });
}

Canvases Presenter::canvases(std::span<const Target> targets, const Background& background,
                             bool over_target) {
  Canvases found;
  gl::Context& context = dispatcher_.context();
  if (targets.size() > MAX_CANVASES) return {};
  for (const Target& target : targets) {
    framebuffer_of(target);  // throws if the target cannot be drawn into
    if (target.texture != 0)
      context.gl().NamedFramebufferTexture(target_framebuffer_, GL_COLOR_ATTACHMENT0, 0, 0);
    const Target texture = texture_behind(context.gl(), target);
    const auto [format, by_view] = in_place(context.gl(), texture, over_target);
    if (format == GL_NONE) return {};
    render::Canvas& canvas = found.list.emplace_back();
    canvas = {.texture = texture.texture,
              .format = format,
              .level = texture.level,
              .layer = std::max(texture.layer, 0),
              .x = target.x,
              .y = target.y,
              .keeps_alpha = keeps_alpha(target, background),
              .linear = target.linear};
    if (!by_view) continue;
    found.views.push_back(
        std::make_unique<gl::Texture>(context, format, canvas.texture, canvas.level, canvas.layer));
    canvas.texture = found.views.back()->id();
    canvas.level = canvas.layer = 0;
  }
  return found;
}

int depth_rows(const gl::Context& context, std::span<const shared::View> views,
               std::span<const DepthTarget> targets) {
  for (std::size_t k = 0; k < targets.size(); ++k) {
    if (2 * size_of(context.gl(), targets[k]).y > static_cast<int>(views[k].height)) return 1;
  }
  return 2;
}

void Presenter::draw_depth(const render::Frame& frame, std::size_t v, const DepthTarget& target) {
  if (v >= frame.plan().requested_views)
    fail("view {} of a frame of {} views", v, frame.plan().requested_views);
  if (frame.plan().depth() == DEPTH_NONE)
    fail("the frame was drawn without depths: choose one in its settings");
  const double near = target.near_plane, far = target.far_plane;
  if (!(near > 0.0 && far > 0.0 && near != far))
    fail("near_plane {}, far_plane {}: expected different numbers above 0; one may be infinite", near, far);
  const double farthest = std::isinf(near) ? 0.0 : std::isinf(far) ? 1.0 : far / (far - near);
  const double per_inverse = std::isinf(near) ? far : -near * farthest;
  gl::Context& context = dispatcher_.context();
  const gl::Functions& gl = context.gl();
  const shared::View& view = frame.views()[v];
  const gl::SavedState saved(context);
  saved.set_plain();
  if (depth_framebuffer_ == 0) {
    gl.CreateFramebuffers(1, &depth_framebuffer_);
    gl.NamedFramebufferDrawBuffer(depth_framebuffer_, GL_NONE);
    gl.CreateVertexArrays(1, &no_vertices_);
  }
  attach(depth_framebuffer_, GL_DEPTH_ATTACHMENT, target.texture, target.level, target.layer, "depth");
  const glm::ivec2 size = size_of(gl, target);
  {
    const gl::SavedDrawing drawing(context, depth_framebuffer_, no_vertices_, size.x, size.y);
    dispatcher_.draw_whole(
        context.program("present_depth.frag", gl::Number{"IS_DEPTH", frame.plan().has_final_depths(), 2}),
        {{"Colours", frame.colours()}, {"ZSums", frame.z_sums()}},
        {{"first", view.pixel_offset},
         {"width", view.width},
         {"height", view.height},
         {"columns", static_cast<std::uint32_t>(size.x)},
         {"rows", static_cast<std::uint32_t>(size.y)},
         {"farthest", std::bit_cast<std::uint32_t>(static_cast<float>(farthest))},
         {"per_inverse", std::bit_cast<std::uint32_t>(static_cast<float>(per_inverse))}});
  }
  gl.NamedFramebufferTexture(depth_framebuffer_, GL_DEPTH_ATTACHMENT, 0, 0);
}

}  // namespace binosplat::stereo
