#include <bit>

#include "render/stages.h"

namespace binosplat::render {

void blend(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers) {
  const glm::vec3& background = shape.settings.background;
  // The tile test is no part of this program: with every test the same lists give the same bits.
  const gl::Defines defines = {{"TILE_SIZE", std::to_string(shape.settings.tile_size)},
                               {"RECORDS", shape.records ? "1" : "0"},
                               {"WEIGHS", shape.settings.weigh ? "1" : "0"},
                               {"CONTRAST", std::to_string(shape.settings.contrast)}};
  dispatcher.run(dispatcher.context().program("blend.comp", defines), gl::Work::of_groups(shape.tile_count),
                 {{"Views", buffers.views},
                  {"Ranges", buffers.ranges},
                  {"Values", buffers.pairs.values()},
                  {"Splats", buffers.splats},
                  {"Colours", buffers.colours},
                  {"ZSums", buffers.z_sums},
                  {"FrameCounters", buffers.counters},
                  {"Measured", buffers.measured}},
                 {{"view_count", shape.view_count()},
                  {"remembers", shape.remembers ? 1u : 0u},
                  {"background_r", std::bit_cast<std::uint32_t>(background.r)},
                  {"background_g", std::bit_cast<std::uint32_t>(background.g)},
                  {"background_b", std::bit_cast<std::uint32_t>(background.b)},
                  {"tile_count", shape.tile_count},
                  {"list_per_view", shape.settings.tiles == TILES_ALL ? 1u : 0u}});
}

}  // namespace binosplat::render
