#include "render/ray_blend.h"

#include "render/stages.h"

namespace binosplat::render {

FrameReport RayBlend::set_views(std::span<const shared::View> views, const FrameSettings& settings) {
  FrameSettings between = exact_of(settings);
  between.between = true;
  return frame_.draw_until(Stage::ranges, views, between);
}

double RayBlend::blend(std::uint32_t v, const gl::Buffer& rays, std::uint32_t count, gl::Buffer& colours,
                       gl::Buffer& z_sums) {
  const FrameShape& shape = frame_.shape();
  FrameBuffers& buffers = frame_.buffers();
  gl::Defines defines = {{"TILE_SIZE", std::to_string(shape.settings.tile_size)},
                         {"SUPERTILE_SIDE", std::to_string(shape.supertile_side)},
                         {"HALF", "0"}};
  add_projection(defines, shape.perspective.projection);
  dispatcher_.begin_frame();
  dispatcher_.begin_stage("blend");
  dispatcher_.run(context().program("blend_rays.comp", defines), gl::Work::threads(count, THREADS),
                  {{"Views", buffers.views},
                   {"Ranges", buffers.ranges_of_tiles(shape)},
                   {"Values", buffers.values_of_tiles(shape)},
                   {"Splats", buffers.splats},
                   {"Rays", rays},
                   {"Colours", colours},
                   {"ZSums", z_sums},
                   {"FrameCounters", buffers.counters}},
                  {{"ray_count", count}, {"view_index", v}});
  dispatcher_.end_frame();
  const double ms = dispatcher_.wait_and_time().front().ms;
  refuse_cut(context(), buffers.counters.read<shared::Counters>(1).front());
  return ms;
}

}  // namespace binosplat::render
