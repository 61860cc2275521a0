#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <stdexcept>

#include "base/error.h"
#include "render/stages.h"
#include "render/variants.h"

namespace binosplat::render {

namespace {

// The task of a walk through the lists: the pictures, or another result.
struct BlendTask {
  int measure = MEASURE_NONE;
  int debug_view = SHOW_PICTURE;
  ListMeans means;
  bool is_probe = false;  // draws the probe's tiles instead of the requested views'
  float scale = 0.0f;     // of the transposed blend
};

// With more tiles per splat, short lists use large_splats; with more splats per tile, many_splats.
constexpr double large_tiles = 8.0, many_in_tile = 80.0;

// Measurements other than visibility, TILES_ALL with its one list per view, and broad tiles use the general
// program.
// Software renderers run several invocations as one, and loads take most time, so they have their own.
BlendProgram program_for(const gl::Context& context, const FramePlan& plan, const BlendVariant& v) {
  const bool is_plain = v.draws() ? v.measure == MEASURE_NONE : v.measure == MEASURE_VISIBILITY;
  if (!is_plain || plan.settings.tiles == TILES_ALL || plan.has_broad_tiles()) return BlendProgram::general;
  if (context.limits().subgroups_of_32) return BlendProgram::subgroups;
  return context.software() && plan.list_parts == 1 ? BlendProgram::software : BlendProgram::general;
}

// In the exact blend a pixel's colour does not depend on the tile test. In both blends, exact and
// approximate, the colour does not depend on the number of pixels per invocation.
const gl::Program& program(gl::Context& context, const FramePlan& plan, const BlendTask& task,
                           bool long_lists, bool large_splats, bool many_splats) {
  BlendVariant v{.long_lists = long_lists,
                 .half = plan.settings.precision == PRECISION_HALF,
                 .measure = task.measure,
                 .debug_view = task.debug_view != SHOW_PICTURE,
                 .approximate = plan.is_approximate(task.is_probe),
                 .projection = plan.perspective.projection,
                 .large_splats = large_splats,
                 .many_splats = many_splats};
  if (v.draws()) {
    v.depth = plan.depth();
    v.canvases = !plan.canvases.empty();
    v.mesh_depth = !plan.meshes.depths.empty();
  }
  v.discs = plan.has_discs() && (v.draws() || v.debug_view);
  v.program = program_for(context, plan, v);
  if (!v.is_legal()) v.many_splats = false;
  if (!v.is_legal()) v.large_splats = false;
  const bool has_light =
      plan.models.front().linear ||
      std::ranges::any_of(plan.canvases, [](const Canvas& c) { return c.keeps_alpha == 2; });
  v.plain = !task.is_probe && !plan.draws_regions() && !plan.has_broad_tiles() && !has_light;
  if (!v.is_legal()) v.plain = false;
  if (!v.is_legal()) throw std::logic_error("illegal variant of the blend (render/variants.cpp)");
  return context.program(v.shader(), v);
}

// Starts the walk through the lists of the requested views, or of the probe.
void start(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers, const BlendTask& task,
           const gl::Buffer& measured) {
  gl::Context& context = dispatcher.context();
  const bool large = task.means.tiles_a_splat > large_tiles, many = task.means.splats_a_tile > many_in_tile;
  for (int k = 0; task.means.tiles_a_splat == 0.0 && k < 4; ++k)  // compiles programs of later frames
    program(context, plan, task, false, k % 2 == 1, k / 2 == 1);
  const std::uint32_t first_of_probe =
      plan.probe ? plan.views.back().supertile_offset * SUPERTILE_SIDE * SUPERTILE_SIDE : plan.tile_count();
  const std::uint32_t parts = task.debug_view == SHOW_PICTURE ? plan.list_parts : 1;
  const std::uint32_t first = task.is_probe ? first_of_probe : 0;
  const std::uint32_t end = task.is_probe ? plan.tile_count() : first_of_probe;
  const auto draw = [&](bool long_lists, const gl::DispatchSize& size, std::uint32_t part = 0) {
    dispatcher.start(
        program(context, plan, task, long_lists, large, many), size,
        {{"Frame", buffers.parameters},
         {"Views", buffers.views},
         {"RegionRows", buffers.region_rows},
         {"Ranges", buffers.lists.tile_ranges},
         {"Values", buffers.lists.tile_values},
         {"Splats", buffers.projected.splats},
         {"Discs", buffers.projected.discs},
         {"Colours", buffers.pictures.colours},
         {"Canvases", buffers.pictures.canvases},
         {"ZSums", buffers.pictures.z_sums},
         {"MeshSources", buffers.pictures.mesh_sources},
         {"FrameCounters", buffers.counters},
         {"LongLists", buffers.lists.long_lists},
         {"Measured", measured},
         {"Unfinished", buffers.pictures.unfinished},
         {"DebugView", buffers.pictures.debug_values}},
        {{"first_tile", first},
         {"end_tile", end},
         {"before_part", part * LIST_PART},
         {"part_size", part + 1 == parts ? ~0u : LIST_PART},  // a longer list is cut, and noticed
         {"scale", std::bit_cast<std::uint32_t>(task.scale)},
         {"shown", static_cast<std::uint32_t>(task.debug_view)}});
  };
  for (std::uint32_t part = 0; part < parts; ++part) {
    draw(true, gl::DispatchSize::indirect(buffers.counters, offsetof(shared::Counters, long_x)), part);
    if (parts > 1) dispatcher.wait_for_writes();
  }
  draw(false, gl::DispatchSize::of_groups(end - first));
}

void run(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers, const BlendTask& task,
         const gl::Buffer& measured) {
  gl::Context& context = dispatcher.context();
  const bool on_canvases =
      task.measure <= MEASURE_TRANSMITTANCE && task.debug_view == SHOW_PICTURE && !plan.canvases.empty();
  for (std::size_t k = 0; on_canvases && k < plan.canvases.size(); ++k) {
    const Canvas& to = plan.canvases[k];
    context.gl().BindImageTexture(static_cast<GLuint>(k), to.texture, to.level, GL_FALSE, to.layer,
                                  GL_WRITE_ONLY, to.format);
    if (!plan.meshes.depths.empty()) buffers.nearest.bind(static_cast<GLuint>(k), to.texture);
  }
  for (std::size_t k = 0; k < plan.meshes.depths.size(); ++k)
    buffers.nearest.bind(static_cast<GLuint>(MAX_CANVASES + k), plan.meshes.depths[k].texture);
  if (plan.probe && task.measure <= MEASURE_TRANSMITTANCE && task.debug_view == SHOW_PICTURE)
    start(dispatcher, plan, buffers, {.means = task.means, .is_probe = true}, measured);
  start(dispatcher, plan, buffers, task, measured);
  dispatcher.wait_for_writes();
  if (on_canvases) context.gl().MemoryBarrier(GL_ALL_BARRIER_BITS);  // before any use of the pictures
}

}  // namespace

void blend(gl::Dispatcher& dispatcher, const FramePlan& plan, bool measures, const ListMeans& means,
           FrameBuffers& buffers) {
  run(dispatcher, plan, buffers, {.measure = measures ? MEASURE_TRANSMITTANCE : MEASURE_NONE, .means = means},
      buffers.transmittance.measured);
}

void blend_debug_view(gl::Dispatcher& dispatcher, const FramePlan& plan, int what, FrameBuffers& buffers) {
  buffers.pictures.debug_values.reserve(plan.pixel_count * 4);
  buffers.pictures.debug_transmittance.reserve(4);  // bound by all debug views, read by one
  if (what == SHOW_TRANSMITTANCE) {                 // shows max(T), which is measured first
    buffers.pictures.debug_transmittance.reserve_zeros(std::int64_t{buffers.slots} * plan.view_count() * 4);
    run(dispatcher, plan, buffers, {.measure = MEASURE_TRANSMITTANCE, .debug_view = SHOW_VISIBLE},
        buffers.pictures.debug_transmittance);
  }
  run(dispatcher, plan, buffers, {.debug_view = what}, buffers.pictures.debug_transmittance);
}

void recolour(gl::Dispatcher& dispatcher, std::uint32_t slots, const gl::Buffer& colours,
              FrameBuffers& buffers) {
  dispatcher.run(dispatcher.context().program("recolour.comp"), gl::DispatchSize::threads(slots, THREADS),
                 {{"Colours", colours}, {"Splats", buffers.projected.splats}}, {{"slot_count", slots}});
}

void blend_transposed(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers, float scale,
                      const gl::Buffer& sums) {
  run(dispatcher, plan, buffers, {.measure = MEASURE_TRANSPOSED, .scale = scale}, sums);
}

void blend_changes(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers,
                   const gl::Buffer& sums) {
  run(dispatcher, plan, buffers, {.measure = MEASURE_CHANGES}, sums);
}

void blend_visibility(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers,
                      const gl::Buffer& sums) {
  run(dispatcher, plan, buffers, {.measure = MEASURE_VISIBILITY}, sums);
}

void throw_if_truncated(const gl::Context& context, const shared::Counters& counters) {
  if (counters.truncated_lists == 0) return;
  throw Error(
      ExitCode::out_of_memory,
      fmt::format("{} ended a tile's list early: too many Gaussians in one tile for this driver. Use a "
                  "smaller model, or a GPU.",
                  context.renderer()));
}

void store_measured(gl::Dispatcher& dispatcher, const FramePlan& plan, bool measures, FrameBuffers& buffers) {
  if (!measures) return;
  const gl::Program& program = dispatcher.context().program("blend_measured.comp");
  for (std::size_t group = 0; group < plan.groups.size(); ++group) {
    const DrawnBuffers& drawn = *buffers.drawn[group];
    dispatcher.run(
        program, gl::DispatchSize::indirect(drawn.arguments, offsetof(shared::DispatchArguments, threads_x)),
        {{"Frame", buffers.parameters},
         {"Arguments", drawn.arguments},
         {"Indices", drawn.indices},
         {"Coverages", buffers.projected.coverages},
         {"Measured", buffers.transmittance.measured},
         {"NextBounds", *buffers.transmittance.next_bounds}},
        {{"view_begin", plan.groups[group].begin},
         {"view_end", std::min(plan.groups[group].end, plan.requested_views)}});
  }
}

}  // namespace binosplat::render
