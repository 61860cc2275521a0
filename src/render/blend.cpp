#include <bit>

#include "render/stages.h"

namespace binosplat::render {

namespace {

void run(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers,
         const gl::Defines& defines, const gl::Buffer& measured) {
  const glm::vec3& background = shape.settings.background;
  dispatcher.run(dispatcher.context().program("blend.comp", defines), gl::Work::of_groups(shape.tile_count),
                 {{"Views", buffers.views},
                  {"Ranges", buffers.ranges},
                  {"Values", buffers.pairs.values()},
                  {"Splats", buffers.splats},
                  {"Colours", buffers.colours},
                  {"ZSums", buffers.z_sums},
                  {"FrameCounters", buffers.counters},
                  {"Measured", measured},
                  {"Shown", buffers.shown}},
                 {{"view_count", shape.view_count()},
                  {"remembers", shape.remembers ? 1u : 0u},
                  {"background_r", std::bit_cast<std::uint32_t>(background.r)},
                  {"background_g", std::bit_cast<std::uint32_t>(background.g)},
                  {"background_b", std::bit_cast<std::uint32_t>(background.b)},
                  {"tile_count", shape.tile_count},
                  {"list_per_view", shape.settings.tiles == TILES_ALL ? 1u : 0u}});
}

// The tile test is no part of this program: with every test the same lists give the same bits.
gl::Defines defines_of(const FrameShape& shape, bool records, bool weighs, int contrast) {
  return {{"TILE_SIZE", std::to_string(shape.settings.tile_size)},
          {"RECORDS", records ? "1" : "0"},
          {"WEIGHS", weighs ? "1" : "0"},
          {"CONTRAST", std::to_string(contrast)}};
}

}  // namespace

void blend(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers) {
  run(dispatcher, shape, buffers,
      defines_of(shape, shape.records, shape.settings.weigh, shape.settings.contrast), buffers.measured);
}

void show(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers, int what) {
  buffers.shown.reserve(shape.pixel_count * 4);
  const auto with = [&](bool records, int show) {
    gl::Defines defines = defines_of(shape, records, false, CONTRAST_OFF);
    defines.emplace_back("SHOW", std::to_string(show));
    run(dispatcher, shape, buffers, defines, buffers.shown_light);
  };
  if (what == SHOW_LIGHT) {
    buffers.shown_light.upload(std::vector<std::uint32_t>(std::size_t{shape.slots} * shape.view_count()));
    with(true, SHOW_VISIBLE);  // measures
  }
  with(false, what);
}

}  // namespace binosplat::render
