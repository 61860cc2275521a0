#include "render/stages.h"

namespace binosplat::render {

void order(gl::Dispatcher& dispatcher, const FramePlan& plan, std::uint32_t group, FrameBuffers& buffers) {
  // Depths are positive floats: their bits sort as unsigned numbers do.
  buffers.sort.run(dispatcher, buffers.drawn[group]->arguments, buffers.ordering.order,
                   plan.groups[group].key_bits);
  dispatcher.finish_beside();  // project()'s last part
}

}  // namespace binosplat::render
