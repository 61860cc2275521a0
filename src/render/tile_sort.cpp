#include "render/stages.h"

namespace binosplat::render {

void tile_sort(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers) {
  if (plan.groups.size() > 1)
    count_pairs(dispatcher, plan, ARGUMENTS_ALL_PAIRS, buffers);  // else pairs() has
  // The pairs come in depth order, and the sort is stable.
  buffers.sort.run(dispatcher, buffers.lists.pair_arguments, buffers.lists.pairs, plan.supertile_bits());
}

}  // namespace binosplat::render
