#include <fmt/core.h>

#include <cstddef>

#include "render/stages.h"

namespace binosplat::render {

namespace {

// Of models that are not decoded no shader looks at it.
const gl::Buffer& kept_of(const ModelBuffers& model, std::size_t page, const FrameBuffers& buffers) {
  return model.pages[page].anchors ? *buffers.kept[page] : *model.pages[page].gaussians;
}

constexpr std::uint32_t fills_a_gpu = 1u << 20;  // Gaussians: some times what an H200 has in work

gl::Defines projecting(const FrameShape& shape) {
  gl::Defines defines = pair_defines(shape);
  defines.emplace_back("RECORDS", shape.records ? "1" : "0");
  return defines;
}

// Depths of what the group draws; nothing is kept of the splats yet, so that what is out of sight costs no
// memory.
void cull(gl::Dispatcher& dispatcher, const FrameShape& shape, OrderGroup views, const ModelBuffers& model,
          FrameBuffers& buffers) {
  // A probe is asked with its view, unless it is alone in its group.
  const std::uint32_t end = views.begin < shape.asked ? std::min(views.end, shape.asked) : views.end;
  // An invocation for each eye takes the time of one where a model does not fill the GPU. Elsewhere one
  // invocation asks both where one eye's answer makes the other's unnecessary.
  const bool asks_both = !shape.records && shape.gaussian_count >= fills_a_gpu;
  gl::Defines defines = projecting(shape);
  defines.emplace_back("EYES", end - views.begin > 1 && !asks_both ? "2" : "1");
  const gl::Program& program = dispatcher.context().program("project_cull.comp", defines);
  for (std::size_t p = 0; p < model.pages.size(); ++p) {
    const ModelBuffers::Page& page = model.pages[p];
    dispatcher.run(program, gl::Work::threads(page.count, THREADS),
                   {{"Frame", buffers.parameters},
                    {"Views", buffers.views},
                    {"PartRows", buffers.part_rows},
                    {"Gaussians", *page.gaussians},
                    {"Kept", kept_of(model, p, buffers)},
                    {"DepthKeys", buffers.depth_keys},
                    {"Bounds", *buffers.bounds},
                    {"DepthTable", buffers.depth_table},
                    {"NextBounds", *buffers.next_bounds}},
                   {{"page_first", page.first},
                    {"page_count", page.count},
                    {"view_begin", views.begin},
                    {"view_end", end}});
  }
}

void compact(gl::Dispatcher& dispatcher, const FrameShape& shape, OrderGroup group, const DrawnBuffers& drawn,
             FrameBuffers& buffers) {
  gl::Context& context = dispatcher.context();
  const auto blocks = gl::Work::threads(std::max(1u, shape.gaussian_count), COMPACT_BLOCK);
  const std::uint32_t digit_bits = primitives::RadixSort::digit_bits(group.key_bits);
  if (context.limits().subgroups_of_32) {
    gl::Defines defines = buffers.order.block_define();
    defines.emplace_back("LOOKS_BACK", "1");
    return dispatcher.run(context.program("project_compact.comp", defines), blocks,
                          {{"Frame", buffers.parameters},
                           {"Arguments", drawn.arguments},
                           {"DepthKeys", buffers.depth_keys},
                           {"LookBack", buffers.look_back.words()},
                           {"Keys", buffers.order.keys()},
                           {"Values", buffers.order.values()},
                           {"Indices", drawn.indices},
                           {"FrameCounters", buffers.counters}},
                          {{"nearest_key", group.nearest_key},
                           {"look_back_half", buffers.look_back.next_half()},
                           {"kind", ARGUMENTS_ORDER},
                           {"capacity", shape.slots},
                           {"groups_max", context.limits().groups},
                           {"digit_bits", digit_bits}});
  }
  dispatcher.run(context.program("project_compact_count.comp"), blocks,
                 {{"Frame", buffers.parameters},
                  {"DepthKeys", buffers.depth_keys},
                  {"BlockCounts", buffers.block_counts}});
  buffers.scan.run(dispatcher, buffers.block_arguments, 0, buffers.block_counts);
  dispatcher.run(
      context.program("arguments.comp", buffers.order.block_define()), gl::Work::of_groups(1),
      {{"Arguments", drawn.arguments}, {"Total", buffers.scan.total()}, {"FrameCounters", buffers.counters}},
      {{"kind", ARGUMENTS_ORDER},
       {"capacity", shape.slots},
       {"groups_max", context.limits().groups},
       {"digit_bits", digit_bits}});
  dispatcher.run(context.program("project_compact.comp", {{"LOOKS_BACK", "0"}}), blocks,
                 {{"Frame", buffers.parameters},
                  {"Arguments", drawn.arguments},
                  {"DepthKeys", buffers.depth_keys},
                  {"BlockCounts", buffers.block_counts},
                  {"Keys", buffers.order.keys()},
                  {"Values", buffers.order.values()},
                  {"Indices", drawn.indices}},
                 {{"nearest_key", group.nearest_key}});
}

}  // namespace

gl::Defines::value_type subgroups_define(const gl::Context& context) {
  return {"WITH_SUBGROUPS", context.limits().subgroups_of_32 ? "1" : "0"};
}

void add_projection(gl::Defines& defines, int projection) {
  defines.emplace_back("PROJECTION", std::to_string(projection));
  defines.emplace_back("PROJECTION_NAME", projection_choices[projection].name);
}

gl::Defines pair_defines(const FrameShape& shape) {
  const FrameSettings& s = shape.settings;
  gl::Defines defines = {{"TILES_NAME", tiles_choices[s.tiles].name},
                         {"TH", std::to_string(s.th)},
                         {"TH_NAME", th_choices[s.th].name},
                         {"TRANSMITTANCE", std::to_string(s.transmittance)},
                         {"TILES", std::to_string(s.tiles)},
                         {"TILE_SIZE", std::to_string(s.tile_size)},
                         {"SUPERTILE_SIDE", std::to_string(shape.supertile_side)},
                         {"PROBED", shape.probe ? "1" : "0"},
                         {"PARTS", shape.draws_parts() ? "1" : "0"},
                         {"ANTIALIASED", shape.antialiased ? "1" : "0"},
                         {"HALF", shape.settings.precision == PRECISION_HALF ? "1" : "0"},
                         {"OFFSETS", std::to_string(shape.offset_count)},
                         {"ORDER", std::to_string(shape.perspective.order)},
                         {"BETWEEN", s.between ? "1" : "0"}};
  add_projection(defines, shape.perspective.projection);
  if (shape.kernel_px2 != KERNEL_PX2)
    defines.emplace_back("KERNEL_PX2", fmt::format("{:.9g}", shape.kernel_px2));
  return defines;
}

void project(gl::Dispatcher& dispatcher, const FrameShape& shape, std::uint32_t group,
             const ModelBuffers& model, FrameBuffers& buffers) {
  const OrderGroup views = shape.groups[group];
  cull(dispatcher, shape, views, model, buffers);
  const DrawnBuffers& drawn = *buffers.drawn[group];
  compact(dispatcher, shape, views, drawn, buffers);
  gl::Defines defines = projecting(shape);
  defines.emplace_back("SH_DEGREE", std::to_string(shape.degree));
  defines.push_back(subgroups_define(dispatcher.context()));
  const gl::Program& program = dispatcher.context().program("project.comp", defines);
  for (std::size_t p = 0; p < model.pages.size(); ++p) {
    const ModelBuffers::Page& page = model.pages[p];
    dispatcher.run(program,
                   gl::Work::indirect(drawn.arguments, offsetof(shared::DispatchArguments, threads_x)),
                   {{"Frame", buffers.parameters},
                    {"Views", buffers.views},
                    {"PartRows", buffers.part_rows},
                    {"Gaussians", *page.gaussians},
                    {"Kept", kept_of(model, p, buffers)},
                    {"Harmonics", *page.harmonics},
                    {"Arguments", drawn.arguments},
                    {"Indices", drawn.indices},
                    {"Splats", buffers.splats},
                    {"Coverages", buffers.coverages},
                    {"FrameCounters", buffers.counters},
                    {"Tall", buffers.tall},
                    {"Bounds", *buffers.bounds},
                    {"DepthTable", buffers.depth_table},
                    {"Measured", buffers.measured}},
                   {{"page_first", page.first},
                    {"page_count", page.count},
                    {"view_begin", views.begin},
                    {"view_end", views.end}});
  }
  gl::Defines tall_defines = pair_defines(shape);
  tall_defines.push_back(subgroups_define(dispatcher.context()));
  dispatcher.run(dispatcher.context().program("project_count_tall.comp", tall_defines),
                 gl::Work::indirect(buffers.counters, offsetof(shared::Counters, tall_x)),
                 {{"Frame", buffers.parameters},
                  {"Views", buffers.views},
                  {"PartRows", buffers.part_rows},
                  {"FrameCounters", buffers.counters},
                  {"Tall", buffers.tall},
                  {"Splats", buffers.splats},
                  {"Coverages", buffers.coverages}});
}

}  // namespace binosplat::render
