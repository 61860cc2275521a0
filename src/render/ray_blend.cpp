#include "render/ray_blend.h"

#include <array>

#include "render/stages.h"
#include "render/variants.h"

namespace binosplat::render {

Report RayBlend::set_views(std::span<const shared::View> views, const FrameSettings& settings) {
  return frame_.draw_until(Stage::sort, views, exact_of(settings), {.between_pixels = true});
}

double RayBlend::blend(std::uint32_t v, const gl::Buffer& rays, std::uint32_t count, gl::Buffer& colours,
                       gl::Buffer& z_sums) {
  const FramePlan& plan = frame_.plan();
  FrameBuffers& buffers = frame_.buffers();
  const std::array variant = {gl::Number{"HALF", 0, 2}, projection_number(plan.perspective.projection)};
  dispatcher_.begin_frame();
  dispatcher_.begin_stage("blend");
  dispatcher_.run(context().program("blend_rays.comp", variant), gl::DispatchSize::threads(count, THREADS),
                  {{"Frame", buffers.parameters},
                   {"Views", buffers.views},
                   {"Ranges", buffers.lists.tile_ranges},
                   {"Values", buffers.lists.tile_values},
                   {"Splats", buffers.projected.splats},
                   {"Rays", rays},
                   {"Colours", colours},
                   {"ZSums", z_sums},
                   {"FrameCounters", buffers.counters}},
                  {{"ray_count", count}, {"view_index", v}});
  dispatcher_.end_frame();
  const double ms = dispatcher_.wait_and_time().front().ms;
  throw_if_truncated(context(), buffers.counters.read<shared::Counters>(1).front());
  return ms;
}

}  // namespace binosplat::render
