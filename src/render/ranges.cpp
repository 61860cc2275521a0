#include <algorithm>
#include <cstddef>

#include "render/stages.h"

namespace binosplat::render {

namespace {

// The dispatch after it must not need them.
void start_clear(gl::Dispatcher& dispatcher, const gl::Buffer& ranges, std::uint32_t lists) {
  dispatcher.start(dispatcher.context().program("ranges_clear.comp"), gl::Work::threads(2 * lists, THREADS),
                   {{"Ranges", ranges}}, {{"count", 2 * lists}});
}

// Each tile's list out of its supertile's.
void split_lists(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers) {
  gl::Context& context = dispatcher.context();
  start_clear(dispatcher, buffers.tile_ranges, shape.tile_count());
  // The third of the arguments, and below the fourth: arguments.comp.
  constexpr std::size_t third = 2 * sizeof(shared::DispatchArguments);
  const gl::Work blocks =
      gl::Work::indirect(buffers.pair_arguments, third + offsetof(shared::DispatchArguments, threads_x));
  const auto program = [&](const char* writes) -> const gl::Program& {
    return context.program("ranges_of_tiles.comp", {{"SUPERTILE_SIDE", std::to_string(shape.supertile_side)},
                                                    subgroups_define(context),
                                                    {"WRITES", writes}});
  };
  dispatcher.run(program("0"), blocks,
                 {{"Arguments", buffers.pair_arguments},
                  {"Values", buffers.pairs.values()},
                  {"TileCounts", buffers.tile_counts}});
  buffers.scan.run(dispatcher, buffers.pair_arguments, 3, buffers.tile_counts);
  dispatcher.run(program("1"), blocks,
                 {{"Arguments", buffers.pair_arguments},
                  {"Values", buffers.pairs.values()},
                  {"TileCounts", buffers.tile_counts},
                  {"Total", buffers.scan.total()},
                  {"Keys", buffers.pairs.keys()},
                  {"TileRanges", buffers.tile_ranges},
                  {"TileValues", buffers.tile_values},
                  {"FrameCounters", buffers.counters}},
                 {{"capacity", static_cast<std::uint32_t>(buffers.tile_values.bytes() / 4)}});
}

}  // namespace

void ranges(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers) {
  if (shape.supertile_side > 1) {
    split_lists(dispatcher, shape, buffers);
    return;
  }
  start_clear(dispatcher, buffers.ranges, std::max(shape.supertile_count, shape.view_count()));
  dispatcher.wait_for_writes();
  dispatcher.run(
      dispatcher.context().program("ranges.comp"),
      gl::Work::indirect(buffers.pair_arguments, offsetof(shared::DispatchArguments, threads_x)),
      {{"Arguments", buffers.pair_arguments}, {"Keys", buffers.pairs.keys()}, {"Ranges", buffers.ranges}});
}

}  // namespace binosplat::render
