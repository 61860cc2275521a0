#include <fmt/format.h>

#include <bit>
#include <cstddef>

#include "base/error.h"
#include "render/stages.h"

namespace binosplat::render {

namespace {

struct Variant {
  bool records = false;
  int sums = SUMS_NONE;
  int show = SHOW_PICTURE;
};

// LISTS of blending.glsl.
enum class Lists { of_short, of_long };

// Who measures or sums up has the tile's splats before all its pixels; what tests nothing shows what tests
// lose; and other sizes of tiles are for comparing.
bool by_subgroups(const gl::Context& context, const FrameShape& shape, const Variant& variant) {
  const bool plain = !variant.records && variant.sums == SUMS_NONE && variant.show == SHOW_PICTURE;
  const bool usual = shape.settings.tiles != TILES_ALL && shape.settings.tile_size == TILE_SIZE_DEFAULT;
  return context.limits().subgroups_of_32 && plain && usual;
}

// The tile test is no part of these programs: with every test the same lists give the same bits. Nor does a
// pixel's colour depend on how many of them an invocation draws, or on the tiles' size.
const gl::Program& program(gl::Context& context, const FrameShape& shape, const Variant& variant,
                           Lists lists) {
  const bool is_long = lists == Lists::of_long;
  const bool subgroups = by_subgroups(context, shape, variant);
  const char* name = subgroups ? "blend_subgroups.comp" : "blend.comp";
  // Found by trying (README.md). What blend.comp has at once divides BLEND_UNROLL.
  const bool is_tangent = shape.perspective.projection == PROJECTION_TANGENT;
  const int ahead = is_long ? 8 : is_tangent && subgroups ? 3 : 4;
  const bool draws = variant.sums == SUMS_NONE && variant.show == SHOW_PICTURE;
  gl::Defines defines = {{"TILE_SIZE", std::to_string(shape.settings.tile_size)},
                         {"SUPERTILE_SIDE", std::to_string(shape.supertile_side)},
                         {"PROBED", shape.probe ? "1" : "0"},
                         {"PARTS", shape.draws_parts() ? "1" : "0"},
                         {"LISTS", std::to_string(static_cast<int>(lists))},
                         {"COLUMN", is_long ? "1" : "2"},
                         {"AHEAD", std::to_string(ahead)},
                         {"HALF", shape.settings.precision == PRECISION_HALF ? "1" : "0"},
                         {"RECORDS", variant.records ? "1" : "0"},
                         {"SUMS", std::to_string(variant.sums)},
                         {"SHOW", std::to_string(variant.show)},
                         {"MEDIAN", draws && shape.settings.depth == Depth::median ? "1" : "0"}};
  add_projection(defines, shape.perspective.projection);
  return context.program(name, defines);
}

void run(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers, const Variant& variant,
         const gl::Buffer& measured, float scale = 0.0f) {
  gl::Context& context = dispatcher.context();
  const auto draw = [&](Lists lists, const gl::Work& work) {
    dispatcher.start(program(context, shape, variant, lists), work,
                     {{"Frame", buffers.parameters},
                      {"Views", buffers.views},
                      {"PartRows", buffers.part_rows},
                      {"Ranges", buffers.ranges_of_tiles(shape)},
                      {"Values", buffers.values_of_tiles(shape)},
                      {"Splats", buffers.splats},
                      {"Colours", buffers.colours},
                      {"ZSums", buffers.z_sums},
                      {"FrameCounters", buffers.counters},
                      {"LongLists", buffers.long_lists},
                      {"Measured", measured},
                      {"Shown", buffers.shown}},
                     {{"scale", std::bit_cast<std::uint32_t>(scale)}});
  };
  draw(Lists::of_long, gl::Work::indirect(buffers.counters, offsetof(shared::Counters, long_x)));
  draw(Lists::of_short, gl::Work::of_groups(shape.tile_count()));
  dispatcher.wait_for_writes();
}

}  // namespace

void find_long_lists(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers) {
  if (shape.settings.tiles == TILES_ALL) return;
  dispatcher.run(dispatcher.context().program("blend_long_lists.comp"),
                 gl::Work::threads(shape.tile_count(), THREADS),
                 {{"Frame", buffers.parameters},
                  {"Ranges", buffers.ranges_of_tiles(shape)},
                  {"LongLists", buffers.long_lists},
                  {"FrameCounters", buffers.counters}});
}

void blend(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers) {
  run(dispatcher, shape, buffers, {.records = shape.records}, buffers.measured);
}

void show(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers, int what) {
  buffers.shown.reserve(shape.pixel_count * 4);
  if (what == SHOW_LIGHT) {
    buffers.shown_light.reserve_zeros(std::int64_t{shape.slots} * shape.view_count() * 4);
    run(dispatcher, shape, buffers, {.records = true, .show = SHOW_VISIBLE},
        buffers.shown_light);  // measures
  }
  run(dispatcher, shape, buffers, {.show = what}, buffers.shown_light);
}

void recolour(gl::Dispatcher& dispatcher, std::uint32_t slots, const gl::Buffer& colours,
              FrameBuffers& buffers) {
  dispatcher.run(dispatcher.context().program("recolour.comp"), gl::Work::threads(slots, THREADS),
                 {{"Colours", colours}, {"Splats", buffers.splats}}, {{"slot_count", slots}});
}

void blend_transposed(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers, float scale,
                      const gl::Buffer& sums) {
  run(dispatcher, shape, buffers, {.sums = SUMS_TRANSPOSED}, sums, scale);
}

void blend_changes(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers,
                   const gl::Buffer& sums) {
  run(dispatcher, shape, buffers, {.sums = SUMS_CHANGES}, sums);
}

void refuse_cut(const gl::Context& context, const shared::Counters& counters) {
  if (counters.loop_cut == 0) return;
  throw Error(ExitCode::out_of_memory,
              fmt::format("{} ended a tile's list early: too many Gaussians in one tile for this driver. "
                          "Use smaller tiles (--tile, where a picture is drawn) or a smaller model.",
                          context.renderer()));
}

}  // namespace binosplat::render
