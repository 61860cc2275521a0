#include <algorithm>
#include <array>
#include <cstddef>

#include "render/stages.h"
#include "render/variants.h"

namespace binosplat::render {

namespace {

// Counts the entries of all splats in few supertiles, or writes them if `fills`.
void bin_small(gl::Dispatcher& dispatcher, const FramePlan& plan, bool fills, FrameBuffers& buffers) {
  gl::Context& context = dispatcher.context();
  // Each dispatch covers as many supertiles of a view as shared memory has room for their counters.
  const auto at_a_time = static_cast<std::uint32_t>(
      std::min<std::int64_t>(context.limits().shared_bytes, std::int64_t{48} << 10) / 4 - 64);
  const std::array variant = {gl::Number{"FILLS", fills, 2}, gl::Number{"SUPERTILES", at_a_time, 1 << 14},
                              list_views_number(plan)};
  const gl::Program& program = context.program("bin.comp", variant);
  for (std::uint32_t v = 0; v < plan.view_count(); v += static_cast<std::uint32_t>(plan.list_views)) {
    const gl::Buffer& arguments = buffers.drawn[plan.views[v].order_group]->arguments;
    for (std::uint32_t first = 0; first < plan.supertiles_of(v); first += at_a_time) {
      dispatcher.start(program,
                       gl::DispatchSize::indirect(arguments, offsetof(shared::DispatchArguments, bin_x)),
                       {{"Frame", buffers.parameters},
                        {"Views", buffers.views},
                        {"Arguments", arguments},
                        {"Coverages", buffers.projected.coverages},
                        {"SupertileCounts", buffers.lists.supertile_counts},
                        {"SupertileEnds", buffers.lists.supertile_ends},
                        {"Depths", buffers.projected.depths},
                        {"Entries", buffers.lists.entries},
                        {"FrameCounters", buffers.counters}},
                       {{"view_index", v}, {"first_supertile", first}});
    }
  }
}

}  // namespace

void bin(gl::Dispatcher& dispatcher, const FramePlan& plan, const Capacity& capacity, FrameBuffers& buffers) {
  gl::Context& context = dispatcher.context();
  PairVariant variant(plan);
  variant.list_views = plan.list_views;
  variant.subgroups = context.limits().subgroups_of_32;
  dispatcher.start(context.program("bin_large.comp", variant),
                   gl::DispatchSize::indirect(buffers.counters, offsetof(shared::Counters, large_x)),
                   {{"Frame", buffers.parameters},
                    {"Views", buffers.views},
                    {"RegionRows", buffers.region_rows},
                    {"FrameCounters", buffers.counters},
                    {"Large", buffers.projected.large},
                    {"Splats", buffers.projected.splats},
                    {"Coverages", buffers.projected.coverages},
                    {"SupertileCounts", buffers.lists.supertile_counts},
                    {"Entries", buffers.lists.entries}},
                   {{"first_entry", buffers.lists.large_offset},
                    {"capacity", static_cast<std::uint32_t>(capacity.large_pairs)}});
  bin_small(dispatcher, plan, false, buffers);
  dispatcher.wait_for_writes();
  dispatcher.run(context.program("bin_place.comp", list_views_number(plan)),
                 gl::DispatchSize::threads(plan.supertile_count, THREADS),
                 {{"Frame", buffers.parameters},
                  {"Views", buffers.views},
                  {"FrameCounters", buffers.counters},
                  {"SupertileCounts", buffers.lists.supertile_counts},
                  {"SupertileEnds", buffers.lists.supertile_ends},
                  {"TileRanges", buffers.lists.tile_ranges},
                  {"Items", buffers.lists.items}},
                 {{"supertile_count", plan.supertile_count},
                  {"item_capacity", buffers.lists.item_capacity},
                  {"rounds", static_cast<std::uint32_t>(capacity.rounds)},
                  {"capacity", static_cast<std::uint32_t>(capacity.pairs)},
                  {"groups_max", context.limits().groups}});
  dispatcher.start(context.program("bin_fill_large.comp", list_views_number(plan)),
                   gl::DispatchSize::indirect(buffers.counters, offsetof(shared::Counters, fill_x)),
                   {{"Frame", buffers.parameters},
                    {"Views", buffers.views},
                    {"FrameCounters", buffers.counters},
                    {"SupertileEnds", buffers.lists.supertile_ends},
                    {"Depths", buffers.projected.depths},
                    {"Entries", buffers.lists.entries}},
                   {{"first_entry", buffers.lists.large_offset}});
  bin_small(dispatcher, plan, true, buffers);
  dispatcher.wait_for_writes();
}

}  // namespace binosplat::render
