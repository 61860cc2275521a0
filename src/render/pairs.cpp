#include <algorithm>
#include <cstddef>

#include "render/stages.h"

namespace binosplat::render {

void count_pairs(gl::Dispatcher& dispatcher, const FrameShape& shape, std::uint32_t kind,
                 FrameBuffers& buffers) {
  gl::Context& context = dispatcher.context();
  dispatcher.run(context.program("arguments.comp", buffers.pairs.block_define()), gl::Work::of_groups(1),
                 {{"Arguments", buffers.pair_arguments},
                  {"Total", buffers.scan.total()},
                  {"FrameCounters", buffers.counters}},
                 {{"kind", kind},
                  {"capacity", static_cast<std::uint32_t>(buffers.pairs.capacity())},
                  {"groups_max", context.limits().groups},
                  {"digit_bits", primitives::RadixSort::digit_bits(shape.supertile_bits())}});
}

void pairs(gl::Dispatcher& dispatcher, const FrameShape& shape, std::uint32_t group, FrameBuffers& buffers) {
  gl::Context& context = dispatcher.context();
  const OrderGroup views = shape.groups[group];
  const gl::Buffer& drawn = buffers.drawn[group]->arguments;
  const auto each = [](const gl::Buffer& arguments) {
    return gl::Work::indirect(arguments, offsetof(shared::DispatchArguments, threads_x));
  };
  const bool both_eyes = shape.view_count() == 2 && shape.groups.size() == 1;
  dispatcher.run(context.program("pairs_count.comp", {{"BOTH_EYES", both_eyes ? "1" : "0"}}), each(drawn),
                 {{"Frame", buffers.parameters},
                  {"Arguments", drawn},
                  {"Order", buffers.order.values()},
                  {"Coverages", buffers.coverages},
                  {"PairOffsets", buffers.pair_offsets},
                  {"CoverageInOrder", buffers.coverage_in_order}},
                 {{"view_begin", views.begin}, {"view_end", views.end}});
  buffers.scan.run(dispatcher, drawn, 0, buffers.pair_offsets);
  count_pairs(dispatcher, shape, ARGUMENTS_PAIRS, buffers);
  gl::Defines defines = pair_defines(shape);
  defines.push_back(subgroups_define(context));
  dispatcher.run(context.program("pairs.comp", defines),
                 gl::Work::indirect(buffers.pair_arguments, offsetof(shared::DispatchArguments, scan_x)),
                 {{"Frame", buffers.parameters},
                  {"OrderArguments", drawn},
                  {"PairArguments", buffers.pair_arguments},
                  {"Views", buffers.views},
                  {"PartRows", buffers.part_rows},
                  {"Order", buffers.order.values()},
                  {"PairOffsets", buffers.pair_offsets},
                  {"CoverageInOrder", buffers.coverage_in_order},
                  {"Splats", buffers.splats},
                  {"Keys", buffers.pairs.keys()},
                  {"Values", buffers.pairs.values()}},
                 {{"view_begin", views.begin}, {"view_end", views.end}});
}

}  // namespace binosplat::render
