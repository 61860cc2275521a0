#include <cstddef>

#include "render/stages.h"
#include "render/variants.h"

namespace binosplat::render {

namespace {

// Only shaders that decode read `kept`; other models bind any buffer.
const gl::Buffer& kept_of(const ModelBuffers& model, std::size_t page, const FrameBuffers& buffers) {
  return model.pages[page].anchors ? *buffers.kept[page] : *model.pages[page].gaussians;
}

constexpr std::uint32_t fills_a_gpu = 1u << 20;  // Gaussians: several times an H200's invocations in flight

// Computes the depths of the Gaussians that the group draws. It stores no splats yet, so Gaussians out of
// view cost no memory.
void cull(gl::Dispatcher& dispatcher, const FramePlan& plan, OrderGroup views, PairVariant variant,
          const ModelBuffers& model, FrameBuffers& buffers) {
  // A probe has the Gaussians of its view, unless it is alone in its group.
  const std::uint32_t end = views.begin < plan.asked ? std::min(views.end, plan.asked) : views.end;
  // If a model does not fill the GPU, an invocation per eye takes no longer. In larger models one invocation
  // tests both eyes, and one eye may decide for both.
  const bool asks_both = !variant.measures && plan.gaussian_count >= fills_a_gpu;
  variant.eyes = end - views.begin > 1 && !asks_both ? 2 : 1;
  const gl::Program& program = dispatcher.context().program("project_cull.comp", variant);
  for (std::size_t p = 0; p < model.pages.size(); ++p) {
    const ModelBuffers::Page& page = model.pages[p];
    dispatcher.run(program, gl::DispatchSize::threads(page.count, THREADS),
                   {{"Frame", buffers.parameters},
                    {"Views", buffers.views},
                    {"RegionRows", buffers.region_rows},
                    {"Gaussians", *page.gaussians},
                    {"Kept", kept_of(model, p, buffers)},
                    {"DepthKeys", buffers.culled.depth_keys},
                    {"Bounds", *buffers.transmittance.bounds},
                    {"DepthTable", buffers.transmittance.depth_table},
                    {"NextBounds", *buffers.transmittance.next_bounds}},
                   {{"page_first", page.first},
                    {"page_count", page.count},
                    {"view_begin", views.begin},
                    {"view_end", end}});
  }
}

void compact(gl::Dispatcher& dispatcher, const FramePlan& plan, std::uint32_t group,
             const DrawnBuffers& drawn, FrameBuffers& buffers) {
  gl::Context& context = dispatcher.context();
  const auto blocks = gl::DispatchSize::threads(std::max(1u, plan.gaussian_count), COMPACT_BLOCK);
  const bool looks_back = context.limits().subgroups_of_32;
  if (!looks_back) {
    dispatcher.run(context.program("project_compact_count.comp"), blocks,
                   {{"Frame", buffers.parameters},
                    {"DepthKeys", buffers.culled.depth_keys},
                    {"BlockCounts", buffers.culled.block_counts}});
  }
  dispatcher.run(context.program("project_compact.comp", gl::Number{"LOOKS_BACK", looks_back, 2}), blocks,
                 {{"Frame", buffers.parameters},
                  {"Arguments", drawn.arguments},
                  {"DepthKeys", buffers.culled.depth_keys},
                  {"BlockCounts", buffers.culled.block_counts},
                  {"LookBack", buffers.look_back.words()},
                  {"Depths", buffers.projected.depths},
                  {"Indices", drawn.indices},
                  {"FrameCounters", buffers.counters}},
                 {{"order_group", group},
                  {"look_back_half", looks_back ? buffers.look_back.next_half() : 0},
                  {"capacity", buffers.slots},
                  {"groups_max", context.limits().groups}});
}

}  // namespace

void project(gl::Dispatcher& dispatcher, const FramePlan& plan, std::uint32_t group, bool measures,
             const ModelBuffers& model, FrameBuffers& buffers) {
  const OrderGroup views = plan.groups[group];
  PairVariant variant(plan);
  variant.measures = measures;
  cull(dispatcher, plan, views, variant, model, buffers);
  const DrawnBuffers& drawn = *buffers.drawn[group];
  compact(dispatcher, plan, group, drawn, buffers);
  variant.subgroups = dispatcher.context().limits().subgroups_of_32;
  variant.list_views = plan.list_views;
  variant.sh_degree = plan.degree;
  const gl::Program& program = dispatcher.context().program("project.comp", variant);
  for (std::size_t p = 0; p < model.pages.size(); ++p) {
    const ModelBuffers::Page& page = model.pages[p];
    dispatcher.start(
        program, gl::DispatchSize::indirect(drawn.arguments, offsetof(shared::DispatchArguments, threads_x)),
        {{"Frame", buffers.parameters},
         {"Views", buffers.views},
         {"RegionRows", buffers.region_rows},
         {"Gaussians", *page.gaussians},
         {"Kept", kept_of(model, p, buffers)},
         {"Harmonics", *page.harmonics},
         {"Arguments", drawn.arguments},
         {"Indices", drawn.indices},
         {"Splats", buffers.projected.splats},
         {"Coverages", buffers.projected.coverages},
         {"FrameCounters", buffers.counters},
         {"Large", buffers.projected.large},
         {"Bounds", *buffers.transmittance.bounds},
         {"DepthTable", buffers.transmittance.depth_table},
         {"Measured", buffers.transmittance.measured}},
        {{"page_first", page.first},
         {"page_count", page.count},
         {"view_begin", views.begin},
         {"view_end", views.end}});
  }
  dispatcher.wait_for_writes();
}

}  // namespace binosplat::render
