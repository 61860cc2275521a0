#include "render/stages.h"

namespace binosplat::render {

gl::Defines tile_defines(const FrameShape& shape) {
  return {{"TILES", std::to_string(shape.settings.tiles)}, {"TILE_SIZE", std::to_string(shape.settings.tile_size)}};
}

void project(gl::Dispatcher& dispatcher, const FrameShape& shape, const ModelBuffers& model, FrameBuffers& buffers) {
  gl::Defines defines = tile_defines(shape);
  defines.emplace_back("SH_DEGREE", std::to_string(shape.degree));
  dispatcher.run(dispatcher.context().program("project.comp", defines),
                 gl::Work::threads(shape.gaussian_count, THREADS),
                 {{"Views", buffers.views},
                  {"Gaussians", model.gaussians},
                  {"Harmonics", model.harmonics},
                  {"Splats", buffers.splats},
                  {"TileCounts", buffers.tile_counts},
                  {"DepthKeys", buffers.depth_keys}},
                 {{"gaussian_count", shape.gaussian_count}, {"view_count", shape.view_count()}});
}

}  // namespace binosplat::render
