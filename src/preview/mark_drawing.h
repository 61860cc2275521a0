#pragma once
// Draws a frame with lines among its splats. Lines and splats occlude each other.

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "gl/texture.h"
#include "preview/marks.h"
#include "render/frame.h"

namespace binosplat::preview {

class MarkDrawing {
 public:
  explicit MarkDrawing(gl::Context& context);
  ~MarkDrawing();
  MarkDrawing(const MarkDrawing&) = delete;
  MarkDrawing& operator=(const MarkDrawing&) = delete;

  /// Draws the eyes' views with these lines, which enter the frame's colours and depths. `eyes` are `views`
  /// as cameras of the world. Uses no measured transmittance, because lines would falsify it.
  Report draw(render::Frame& frame, std::span<const shared::View> views, std::span<const Camera, 2> eyes,
              render::FrameSettings settings, std::span<const Line> lines);

 private:
  struct Eye {
    explicit Eye(gl::Context& context) : vertices(context, "lines among the splats") {}
    std::unique_ptr<gl::Texture> colours, depths;
    std::uint32_t framebuffer = 0;
    gl::Buffer vertices;  // one buffer for each eye, because an upload may overtake a draw (gl/buffer.h)
  };
  void draw_lines(Eye& eye, const Camera& camera, double near_plane, std::span<const Line> lines);
  void put_behind(gl::Dispatcher& dispatcher, const render::Frame& frame) const;

  gl::Dispatcher dispatcher_;
  gl::Sampler nearest_;
  std::uint32_t no_vertices_ = 0;
  std::array<Eye, 2> eyes_;
};

}  // namespace binosplat::preview
