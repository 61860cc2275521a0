#include <algorithm>
#include <array>
#include <cstddef>

#include "render/stages.h"
#include "render/variants.h"

namespace binosplat::render {

namespace {

// The dispatch after it must not need them.
void start_clear(gl::Dispatcher& dispatcher, const gl::Buffer& ranges, std::uint32_t lists) {
  dispatcher.start(dispatcher.context().program("ranges_clear.comp"),
                   gl::DispatchSize::threads(2 * lists, THREADS), {{"Ranges", ranges}},
                   {{"count", 2 * lists}});
}

// Each tile's list out of its supertile's.
void split_lists(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers) {
  gl::Context& context = dispatcher.context();
  start_clear(dispatcher, buffers.lists.tile_ranges, plan.tile_count());
  // The third of the arguments, and below the fourth: arguments.comp.
  constexpr std::size_t third = 2 * sizeof(shared::DispatchArguments);
  const gl::DispatchSize blocks = gl::DispatchSize::indirect(
      buffers.lists.pair_arguments, third + offsetof(shared::DispatchArguments, threads_x));
  const auto program = [&](bool writes) -> const gl::Program& {
    const std::array variant = {
        gl::Number{"SUPERTILE_SIDE", static_cast<std::uint64_t>(plan.supertile_side), 3},
        subgroups_number(context), gl::Number{"WRITES", writes, 2}};
    return context.program("ranges_of_tiles.comp", variant);
  };
  dispatcher.run(program(false), blocks,
                 {{"Arguments", buffers.lists.pair_arguments},
                  {"Values", buffers.lists.pairs.values()},
                  {"TileCounts", buffers.lists.tile_counts}});
  buffers.scan.run(dispatcher, buffers.lists.pair_arguments, 3, buffers.lists.tile_counts);
  dispatcher.run(program(true), blocks,
                 {{"Arguments", buffers.lists.pair_arguments},
                  {"Values", buffers.lists.pairs.values()},
                  {"TileCounts", buffers.lists.tile_counts},
                  {"Total", buffers.scan.total()},
                  {"Keys", buffers.lists.pairs.keys()},
                  {"TileRanges", buffers.lists.tile_ranges},
                  {"TileValues", buffers.lists.tile_values},
                  {"FrameCounters", buffers.counters}},
                 {{"capacity", static_cast<std::uint32_t>(buffers.lists.tile_values.bytes() / 4)}});
}

}  // namespace

void ranges(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers) {
  if (plan.supertile_side > 1) {
    split_lists(dispatcher, plan, buffers);
    return;
  }
  start_clear(dispatcher, buffers.lists.ranges, std::max(plan.supertile_count, plan.view_count()));
  dispatcher.wait_for_writes();
  dispatcher.run(dispatcher.context().program("ranges.comp"),
                 gl::DispatchSize::indirect(buffers.lists.pair_arguments,
                                            offsetof(shared::DispatchArguments, threads_x)),
                 {{"Arguments", buffers.lists.pair_arguments},
                  {"Keys", buffers.lists.pairs.keys()},
                  {"Ranges", buffers.lists.ranges}});
}

}  // namespace binosplat::render
