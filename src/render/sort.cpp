#include <algorithm>
#include <array>
#include <cstddef>

#include "render/stages.h"
#include "render/variants.h"

namespace binosplat::render {

namespace {

// The size of a dispatch with one work group per list of a kind.
gl::DispatchSize lists_of(std::uint32_t kind, const FrameBuffers& buffers) {
  return gl::DispatchSize::indirect(
      buffers.counters,
      static_cast<std::int64_t>(offsetof(shared::Counters, lists) + kind * sizeof(shared::ListCount) +
                                offsetof(shared::ListCount, groups_x)));
}

}  // namespace

void sort(gl::Dispatcher& dispatcher, const FramePlan& plan, const Capacity& capacity,
          FrameBuffers& buffers) {
  gl::Context& context = dispatcher.context();
  const auto rounds = static_cast<std::uint32_t>(capacity.rounds);
  const auto tile_pairs = static_cast<std::uint32_t>(capacity.tile_pairs);
  // Compiled together with the other programs, because a later frame that needs it must not wait.
  const gl::Program& split =
      context.program("sort_split.comp", std::array{subgroups_number(context), list_views_number(plan)});
  for (std::uint32_t round = 0; round < rounds; ++round) {
    dispatcher.run(split, lists_of(SORT_LONG_KIND + round, buffers),
                   {{"Frame", buffers.parameters},
                    {"FrameCounters", buffers.counters},
                    {"Entries", buffers.lists.entries},
                    {"SlabTiles", buffers.lists.slab_tiles},
                    {"TileRanges", buffers.lists.tile_ranges},
                    {"LongLists", buffers.lists.long_lists},
                    {"ItemsRead", buffers.lists.items},
                    {"Items", buffers.lists.items}},
                   {{"item_capacity", buffers.lists.item_capacity},
                    {"rounds", rounds},
                    {"round", round},
                    {"first_entry", buffers.lists.large_offset},
                    {"capacity", tile_pairs}});
  }
  const auto sort_kind = [&](std::uint32_t kind) {
    // On a software renderer each invocation costs time at each barrier, and each program takes seconds to
    // compile. So a software renderer has few invocations and two programs.
    const bool software = context.software();
    const std::uint32_t each = software ? 4 * SORT_EACH : SORT_EACH;
    const std::uint32_t most = 32 * SORT_EACH << std::min(kind, SORT_CLASSES - 1);  // entries of a list
    const std::uint32_t threads = software ? (most <= 512 ? 32 : SORT_MAX / each) : most / each;
    const std::array variant = {subgroups_number(context), list_views_number(plan),
                                gl::Number{"LIST_THREADS", threads, 1025}, gl::Number{"LIST_EACH", each, 33},
                                gl::Number{"CROWDED", kind == SORT_CROWDED_KIND, 2}};
    dispatcher.start(context.program("sort_lists.comp", variant), lists_of(kind, buffers),
                     {{"Frame", buffers.parameters},
                      {"FrameCounters", buffers.counters},
                      {"ItemsRead", buffers.lists.items},
                      {"Items", buffers.lists.items},
                      {"Entries", buffers.lists.entries},
                      {"SlabTiles", buffers.lists.slab_tiles},
                      {"TileRanges", buffers.lists.tile_ranges},
                      {"LongLists", buffers.lists.long_lists},
                      {"TileValues", buffers.lists.tile_values}},
                     {{"kind", kind},
                      {"item_capacity", buffers.lists.item_capacity},
                      {"rounds", rounds},
                      {"capacity", tile_pairs}});
  };
  for (std::uint32_t kind = SORT_CLASSES; kind-- > 0;) sort_kind(kind);  // the slowest first
  dispatcher.wait_for_writes();
  sort_kind(SORT_CROWDED_KIND);  // lists that the other kinds have skipped
  dispatcher.wait_for_writes();
}

}  // namespace binosplat::render
