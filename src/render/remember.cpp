#include <cstddef>

#include "render/stages.h"

namespace binosplat::render {

void remember(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers) {
  if (shape.settings.transmittance == TRANSMITTANCE_ONE) return;
  for (std::size_t group = 0; group < shape.groups.size(); ++group) {
    const DrawnBuffers& drawn = *buffers.drawn[group];
    dispatcher.run(dispatcher.context().program("remember.comp"),
                   gl::Work::indirect(drawn.amounts, offsetof(shared::Amount, threads_x)),
                   {{"Amounts", drawn.amounts},
                    {"Indices", drawn.indices},
                    {"TileCounts", buffers.tile_counts},
                    {"Measured", buffers.measured},
                    {"UpperNext", *buffers.upper_next}},
                   {{"gaussian_count", shape.gaussian_count},
                    {"view_begin", shape.groups[group].begin},
                    {"view_end", shape.groups[group].end},
                    {"slots", shape.slots}});
  }
}

}  // namespace binosplat::render
