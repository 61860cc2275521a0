#include "render/stages.h"

namespace binosplat::render {

void tile_sort(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers) {
  gl::Context& context = dispatcher.context();
  if (shape.groups.size() > 1) {  // else the stage pairs has counted all
    dispatcher.run(context.program("amount.comp", buffers.pairs.block_define()), gl::Work::of_groups(1),
                   {{"Amounts", buffers.pair_amounts},
                    {"Total", buffers.scan.total()},
                    {"FrameCounters", buffers.counters}},
                   {{"kind", AMOUNT_ALL_PAIRS},
                    {"capacity", static_cast<std::uint32_t>(buffers.pairs.capacity())},
                    {"groups_max", context.limits().groups},
                    {"digit_bits", primitives::RadixSort::digit_bits(shape.list_bits())}});
  }
  // The pairs come in depth order, and the sort is stable.
  buffers.sort.run(dispatcher, buffers.pair_amounts, buffers.pairs, shape.list_bits());
}

}  // namespace binosplat::render
