#include "render/stages.h"

namespace binosplat::render {

void tile_sort(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers) {
  if (shape.groups.size() > 1)
    count_pairs(dispatcher, shape, ARGUMENTS_ALL_PAIRS, buffers);  // else pairs() has
  // The pairs come in depth order, and the sort is stable.
  buffers.sort.run(dispatcher, buffers.pair_arguments, buffers.pairs, shape.supertile_bits());
}

}  // namespace binosplat::render
