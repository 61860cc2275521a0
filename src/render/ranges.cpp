#include <algorithm>
#include <cstddef>

#include "render/stages.h"

namespace binosplat::render {

void ranges(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers) {
  gl::Context& context = dispatcher.context();
  const std::uint32_t bounds = 2 * std::max(shape.tile_count, shape.view_count());
  dispatcher.run(context.program("ranges_clear.comp"), gl::Work::threads(bounds, THREADS),
                 {{"Ranges", buffers.ranges}}, {{"count", bounds}});
  dispatcher.run(
      context.program("ranges.comp"),
      gl::Work::indirect(buffers.pair_amounts, offsetof(shared::Amount, threads_x)),
      {{"Amounts", buffers.pair_amounts}, {"Keys", buffers.pairs.keys()}, {"Ranges", buffers.ranges}});
}

}  // namespace binosplat::render
