#include "render/stages.h"

namespace binosplat::render {

void order(gl::Dispatcher& dispatcher, FrameBuffers& buffers) {
  // Depths are positive floats: their bits sort as unsigned numbers do.
  buffers.sort.run(dispatcher, buffers.order_amounts, buffers.order, 32);
}

}  // namespace binosplat::render
