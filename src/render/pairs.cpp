#include <algorithm>
#include <cstddef>

#include "render/stages.h"

namespace binosplat::render {

void count_pairs(gl::Dispatcher& dispatcher, const FrameShape& shape, std::uint32_t kind,
                 FrameBuffers& buffers) {
  gl::Context& context = dispatcher.context();
  dispatcher.run(context.program("amount.comp", buffers.pairs.block_define()), gl::Work::of_groups(1),
                 {{"Amounts", buffers.pair_amounts},
                  {"Total", buffers.scan.total()},
                  {"FrameCounters", buffers.counters}},
                 {{"kind", kind},
                  {"capacity", static_cast<std::uint32_t>(buffers.pairs.capacity())},
                  {"groups_max", context.limits().groups},
                  {"digit_bits", primitives::RadixSort::digit_bits(shape.list_bits())}});
}

void pairs(gl::Dispatcher& dispatcher, const FrameShape& shape, std::uint32_t group, FrameBuffers& buffers) {
  gl::Context& context = dispatcher.context();
  const OrderGroup views = shape.groups[group];
  const gl::Buffer& drawn = buffers.drawn[group]->amounts;
  const auto each = [](const gl::Buffer& amounts) {
    return gl::Work::indirect(amounts, offsetof(shared::Amount, threads_x));
  };
  const bool both_eyes = shape.view_count() == 2 && shape.groups.size() == 1;
  dispatcher.run(context.program("pairs_count.comp", {{"BOTH_EYES", both_eyes ? "1" : "0"}}), each(drawn),
                 {{"Frame", buffers.parameters},
                  {"Amounts", drawn},
                  {"Order", buffers.order.values()},
                  {"Touched", buffers.touched},
                  {"PairOffsets", buffers.pair_offsets},
                  {"TouchedInOrder", buffers.touched_in_order}},
                 {{"view_begin", views.begin}, {"view_end", views.end}});
  buffers.scan.run(dispatcher, drawn, 0, buffers.pair_offsets);
  count_pairs(dispatcher, shape, AMOUNT_PAIRS, buffers);
  gl::Defines defines = pair_defines(shape);
  defines.push_back(subgroups_define(context));
  dispatcher.run(context.program("pairs.comp", defines),
                 gl::Work::indirect(buffers.pair_amounts, offsetof(shared::Amount, scan_x)),
                 {{"Frame", buffers.parameters},
                  {"OrderAmounts", drawn},
                  {"PairAmounts", buffers.pair_amounts},
                  {"Views", buffers.views},
                  {"Order", buffers.order.values()},
                  {"PairOffsets", buffers.pair_offsets},
                  {"TouchedInOrder", buffers.touched_in_order},
                  {"Splats", buffers.splats},
                  {"Keys", buffers.pairs.keys()},
                  {"Values", buffers.pairs.values()}},
                 {{"view_begin", views.begin}, {"view_end", views.end}});
}

}  // namespace binosplat::render
