#include "primitives/amount.h"
#include "render/stages.h"

namespace binosplat::render {

void order(gl::Dispatcher& dispatcher, const FrameShape& shape, std::uint32_t group, FrameBuffers& buffers) {
  gl::Context& context = dispatcher.context();
  const auto blocks = gl::Work::threads(shape.gaussian_count, COMPACT_BLOCK);
  dispatcher.run(context.program("order_count.comp"), blocks,
                 {{"DepthKeys", buffers.depth_keys}, {"BlockCounts", buffers.block_counts}},
                 {{"gaussian_count", shape.gaussian_count}, {"order_group", group}});
  buffers.scan.run(dispatcher, buffers.block_amount, 0, buffers.block_counts);
  dispatcher.run(context.program("amount.comp"), gl::Work::of_groups(1),
                 {{"Amounts", buffers.order_amounts},
                  {"Total", buffers.scan.total()},
                  {"FrameCounters", buffers.counters}},
                 {{"kind", AMOUNT_ORDER},
                  {"capacity", static_cast<std::uint32_t>(buffers.order.capacity())},
                  {"groups_max", context.limits().groups}});
  dispatcher.run(context.program("order_compact.comp"), blocks,
                 {{"Amounts", buffers.order_amounts},
                  {"DepthKeys", buffers.depth_keys},
                  {"BlockCounts", buffers.block_counts},
                  {"Keys", buffers.order.keys()},
                  {"Values", buffers.order.values()}},
                 {{"gaussian_count", shape.gaussian_count}, {"order_group", group}});
  // Depths are positive floats: their bits sort as unsigned numbers do.
  buffers.sort.run(dispatcher, buffers.order_amounts, buffers.order, 32);
}

}  // namespace binosplat::render
