#include <algorithm>
#include <cstddef>

#include "render/stages.h"

namespace binosplat::render {

void remember(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers) {
  if (!shape.records && !shape.probe) return;
  const gl::Defines defines = {{"RECORDS", shape.records ? "1" : "0"}};
  for (std::size_t group = 0; group < shape.groups.size(); ++group) {
    const DrawnBuffers& drawn = *buffers.drawn[group];
    dispatcher.run(dispatcher.context().program("blend_remember.comp", defines),
                   gl::Work::indirect(drawn.arguments, offsetof(shared::DispatchArguments, threads_x)),
                   {{"Frame", buffers.parameters},
                    {"Arguments", drawn.arguments},
                    {"Indices", drawn.indices},
                    {"Coverages", buffers.coverages},
                    {"Measured", buffers.measured},
                    {"NextBounds", *buffers.next_bounds},
                    {"OrderKeys", buffers.order.keys()},
                    {"FrameCounters", buffers.counters}},
                   {{"nearest_key", shape.groups[group].nearest_key},
                    {"view_begin", shape.groups[group].begin},
                    {"view_end", std::min(shape.groups[group].end, shape.asked)}});
  }
}

}  // namespace binosplat::render
