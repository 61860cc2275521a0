#include "preview/mark_drawing.h"

#include <algorithm>

#include "gl/state.h"

namespace binosplat::preview {

MarkDrawing::MarkDrawing(gl::Context& context)
    : dispatcher_(context), nearest_(context), eyes_{Eye(context), Eye(context)} {
  context.gl().CreateVertexArrays(1, &no_vertices_);
  for (Eye& eye : eyes_) context.gl().CreateFramebuffers(1, &eye.framebuffer);
}

MarkDrawing::~MarkDrawing() {
  const gl::Functions& gl = dispatcher_.context().gl();
  for (const Eye& eye : eyes_) gl.DeleteFramebuffers(1, &eye.framebuffer);
  gl.DeleteVertexArrays(1, &no_vertices_);
}

void MarkDrawing::draw_lines(Eye& eye, const Camera& camera, double near_plane, std::span<const Line> lines) {
  gl::Context& context = dispatcher_.context();
  const gl::Functions& gl = context.gl();
  const auto fit = [&](std::unique_ptr<gl::Texture>& texture, GLenum format, GLenum place) {
    if (texture && texture->is(format, camera.width, camera.height)) return;
    texture = std::make_unique<gl::Texture>(context, format, camera.width, camera.height);
    gl.NamedFramebufferTexture(eye.framebuffer, place, texture->id(), 0);
  };
  fit(eye.colours, GL_RGBA8, GL_COLOR_ATTACHMENT0);
  fit(eye.depths, GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT);
  // About two px, more in large pictures.
  const double px = std::max(1.5, camera.height / 400.0);
  const std::vector<MarkVertex> corners = triangles(lines, camera, near_plane, px);
  const gl::SavedState saved(context);
  saved.set_plain();
  const gl::SavedDrawing drawing(context, eye.framebuffer, no_vertices_, camera.width, camera.height);
  gl.DepthFunc(GL_LESS);
  gl.ClearColor(0.0f, 0.0f, 0.0f, 0.0f);
  gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  if (corners.empty()) return;
  eye.vertices.upload(corners);
  dispatcher_.draw(context.program("marks.frag"), static_cast<int>(corners.size()),
                   {{"Vertices", eye.vertices}});
}

void MarkDrawing::put_behind(gl::Dispatcher& dispatcher, const render::Frame& frame) const {
  const gl::Program& program = dispatcher.context().program("marks_behind.comp");
  for (std::size_t k = 0; k < eyes_.size(); ++k) {
    const shared::View& view = frame.views()[k];
    nearest_.bind(0, eyes_[k].colours->id());
    dispatcher.run(program,
                   gl::DispatchSize::threads(std::uint64_t{view.width} * view.height, program.local_size()),
                   {{"Colours", frame.colours()}, {"ZSums", frame.z_sums()}},
                   {{"first", view.pixel_offset}, {"width", view.width}, {"height", view.height}});
  }
}

Report MarkDrawing::draw(render::Frame& frame, std::span<const shared::View> views,
                         std::span<const Camera, 2> eyes, render::FrameSettings settings,
                         std::span<const Line> lines) {
  const double near_plane = views[0].anchor.w;
  std::array<render::MeshDepth, 2> depths;
  for (std::size_t k = 0; k < eyes_.size(); ++k) {
    draw_lines(eyes_[k], eyes[k], near_plane, lines);
    // A depth value of 0 gives 1 / z = 1 / near_plane; 1 gives 0.
    depths[k] = {.texture = eyes_[k].depths->id(),
                 .size = {eyes[k].width, eyes[k].height},
                 .scale = static_cast<float>(-1.0 / near_plane),
                 .offset = static_cast<float>(1.0 / near_plane)};
  }
  if (render::measures(settings)) settings.transmittance = Transmittance::one;
  settings.has_depths = true;
  render::DebugOptions debug;
  debug.extra_stage = [&](gl::Dispatcher& dispatcher) { put_behind(dispatcher, frame); };
  debug.extra_stage_name = "lines";
  return frame.draw(views, settings, debug, {.mesh_depths = depths});
}

}  // namespace binosplat::preview
