#include <array>
#include <cstddef>

#include "render/stages.h"
#include "render/variants.h"

namespace binosplat::render {

namespace {

// Of the order group's Gaussians, and the arguments of the pairs.
void count(gl::Dispatcher& dispatcher, const FramePlan& plan, std::uint32_t group, FrameBuffers& buffers) {
  gl::Context& context = dispatcher.context();
  const OrderGroup views = plan.groups[group];
  const gl::Buffer& drawn = buffers.drawn[group]->arguments;
  const bool both_eyes = plan.view_count() == 2 && plan.groups.size() == 1;
  // What a group counts by subgroups must not wrap; the scan's sums stop.
  const bool looks_back =
      context.limits().subgroups_of_32 && std::uint64_t{SCAN_BLOCK} * plan.supertile_count < COUNT_MAX;
  const std::array variant = {gl::Number{"BOTH_EYES", both_eyes, 2}, gl::Number{"LOOKS_BACK", looks_back, 2},
                              buffers.lists.pairs.block_number()};
  dispatcher.run(
      context.program("pairs_count.comp", variant),
      gl::DispatchSize::indirect(drawn, looks_back ? offsetof(shared::DispatchArguments, scan_x)
                                                   : offsetof(shared::DispatchArguments, threads_x)),
      {{"Frame", buffers.parameters},
       {"OrderArguments", drawn},
       {"Order", buffers.ordering.order.values()},
       {"Coverages", buffers.projected.coverages},
       {"PairOffsets", buffers.ordering.pair_offsets},
       {"CoverageInOrder", buffers.projected.coverage_in_order},
       {"Arguments", buffers.lists.pair_arguments},
       {"FrameCounters", buffers.counters},
       {"LookBack", buffers.look_back.words()}},
      {{"view_begin", views.begin},
       {"view_end", views.end},
       {"look_back_half", looks_back ? buffers.look_back.next_half() : 0},
       {"kind", ARGUMENTS_PAIRS},
       {"capacity", static_cast<std::uint32_t>(buffers.lists.pairs.capacity())},
       {"groups_max", context.limits().groups},
       {"digit_bits", primitives::RadixSort::digit_bits(plan.supertile_bits())}});
  if (looks_back) return;
  buffers.scan.run(dispatcher, drawn, 0, buffers.ordering.pair_offsets);
  count_pairs(dispatcher, plan, ARGUMENTS_PAIRS, buffers);
}

}  // namespace

void count_pairs(gl::Dispatcher& dispatcher, const FramePlan& plan, std::uint32_t kind,
                 FrameBuffers& buffers) {
  gl::Context& context = dispatcher.context();
  dispatcher.run(context.program("arguments.comp", buffers.lists.pairs.block_number()),
                 gl::DispatchSize::of_groups(1),
                 {{"Arguments", buffers.lists.pair_arguments},
                  {"Total", buffers.scan.total()},
                  {"FrameCounters", buffers.counters}},
                 {{"kind", kind},
                  {"capacity", static_cast<std::uint32_t>(buffers.lists.pairs.capacity())},
                  {"groups_max", context.limits().groups},
                  {"digit_bits", primitives::RadixSort::digit_bits(plan.supertile_bits())}});
}

void pairs(gl::Dispatcher& dispatcher, const FramePlan& plan, std::uint32_t group, FrameBuffers& buffers) {
  gl::Context& context = dispatcher.context();
  const OrderGroup views = plan.groups[group];
  const gl::Buffer& drawn = buffers.drawn[group]->arguments;
  count(dispatcher, plan, group, buffers);
  PairVariant variant(plan);
  variant.subgroups = context.limits().subgroups_of_32;
  dispatcher.run(
      context.program("pairs.comp", variant),
      gl::DispatchSize::indirect(buffers.lists.pair_arguments, offsetof(shared::DispatchArguments, scan_x)),
      {{"Frame", buffers.parameters},
       {"OrderArguments", drawn},
       {"PairArguments", buffers.lists.pair_arguments},
       {"Views", buffers.views},
       {"RegionRows", buffers.region_rows},
       {"Order", buffers.ordering.order.values()},
       {"PairOffsets", buffers.ordering.pair_offsets},
       {"CoverageInOrder", buffers.projected.coverage_in_order},
       {"Splats", buffers.projected.splats},
       {"Keys", buffers.lists.pairs.keys()},
       {"Values", buffers.lists.pairs.values()}},
      {{"view_begin", views.begin}, {"view_end", views.end}});
}

}  // namespace binosplat::render
