#include <cstddef>
#include <vector>

#include "render/stages.h"
#include "render/variants.h"

namespace binosplat::render {

namespace {

// A page of a model. One dispatch projects it for all instances of the model.
struct DrawnPage {
  const PlannedModel& model;
  const ModelBuffers::Page& page;
  std::uint32_t first;     // index of the page's first Gaussian among the frame's
  const gl::Buffer& kept;  // only shaders for Scaffold-GS read it; other models bind any buffer
};

std::vector<DrawnPage> pages_of(const FramePlan& plan, DrawnModels models, const FrameBuffers& buffers) {
  std::vector<DrawnPage> pages;
  std::uint32_t first = 0;
  for (std::size_t m = 0; m < models.size(); ++m) {
    for (std::size_t p = 0; p < models[m]->pages.size(); ++p) {
      const ModelBuffers::Page& page = models[m]->pages[p];
      pages.push_back({plan.models[m], page, first, page.anchors ? *buffers.kept[p] : *page.gaussians});
      first += plan.models[m].instances * page.count;
    }
  }
  return pages;
}

constexpr std::uint32_t fills_a_gpu = 1u << 20;  // Gaussians: several times an H200's invocations in flight

// Computes the depths of the Gaussians that the group draws. Stores no splats yet, so Gaussians out of view
// cost no memory.
void cull(gl::Dispatcher& dispatcher, const FramePlan& plan, OrderGroup views, PairVariant variant,
          std::span<const DrawnPage> pages, FrameBuffers& buffers) {
  // The probe draws Gaussians that the cull kept for its view, unless the probe is alone in its order group.
  const std::uint32_t end =
      views.begin < plan.requested_views ? std::min(views.end, plan.requested_views) : views.end;
  // If a model does not fill the GPU, each eye has an invocation, because both run at once. In larger models,
  // one invocation tests both eyes, and skips the second eye if the first draws the Gaussian.
  const bool asks_both = !variant.measures && plan.gaussian_count >= fills_a_gpu;
  variant.eyes = end - views.begin > 1 && !asks_both ? 2 : 1;
  for (const DrawnPage& drawn : pages) {
    variant.take(drawn.model);
    dispatcher.run(
        dispatcher.context().program("project_cull.comp", variant),
        gl::DispatchSize::threads(std::uint64_t{drawn.model.instances} * drawn.page.count, THREADS),
        {{"Frame", buffers.parameters},
         {"Views", buffers.views_of_instances(plan)},
         {"RegionRows", buffers.region_rows},
         {"Gaussians", *drawn.page.gaussians},
         {"Kept", drawn.kept},
         {"DepthKeys", buffers.culled.depth_keys},
         {"Bounds", *buffers.transmittance.bounds},
         {"DepthTables", buffers.transmittance.depth_tables},
         {"NextBounds", *buffers.transmittance.next_bounds}},
        {{"page_first", drawn.first},
         {"page_count", drawn.page.count},
         {"instance_first", drawn.model.first_instance},
         {"instance_count", drawn.model.instances},
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
             DrawnModels models, FrameBuffers& buffers) {
  const OrderGroup views = plan.groups[group];
  const std::vector<DrawnPage> pages = pages_of(plan, models, buffers);
  PairVariant variant(plan);
  variant.measures = measures;
  cull(dispatcher, plan, views, variant, pages, buffers);
  const DrawnBuffers& drawn = *buffers.drawn[group];
  compact(dispatcher, plan, group, drawn, buffers);
  variant.subgroups = dispatcher.context().limits().subgroups_of_32;
  variant.list_views = plan.list_views;
  variant.discs = plan.has_discs();
  for (const auto& [model, page, first, kept] : pages) {
    variant.take(model);
    variant.sh_degree = model.degree;
    dispatcher.start(
        dispatcher.context().program("project.comp", variant),
        gl::DispatchSize::indirect(drawn.arguments, offsetof(shared::DispatchArguments, threads_x)),
        {{"Frame", buffers.parameters},
         {"Views", buffers.views_of_instances(plan)},
         {"RegionRows", buffers.region_rows},
         {"Gaussians", *page.gaussians},
         {"Kept", kept},
         {"Harmonics", *page.harmonics},
         {"Arguments", drawn.arguments},
         {"Indices", drawn.indices},
         {"Splats", buffers.projected.splats},
         {"Discs", buffers.projected.discs},
         {"Coverages", buffers.projected.coverages},
         {"FrameCounters", buffers.counters},
         {"Large", buffers.projected.large},
         {"Bounds", *buffers.transmittance.bounds},
         {"DepthTables", buffers.transmittance.depth_tables},
         {"Measured", buffers.transmittance.measured}},
        {{"page_first", first},
         {"page_count", page.count},
         {"instance_first", model.first_instance},
         {"instance_count", model.instances},
         {"is_flat", model.flat},
         {"view_begin", views.begin},
         {"view_end", views.end}});
  }
  dispatcher.wait_for_writes();
}

}  // namespace binosplat::render
