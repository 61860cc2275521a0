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

  bool draws() const { return sums == SUMS_NONE && show == SHOW_PICTURE; }
};

// LISTS of blending.glsl.
enum class Lists { of_short, of_long };

// Of most splats, for short lists.
enum class Size { small, large };
constexpr double large_tiles = 8.0;  // that a splat touches

// Who measures or sums up has the tile's splats before all its pixels, but for what is seen, for which frames
// wait; what tests nothing shows what tests lose; and other sizes of tiles are for comparing. A software
// renderer draws some invocations by one of its own, and its loads take the time.
std::string name_of_program(const gl::Context& context, const FrameShape& shape, const Variant& variant) {
  const bool plain = variant.draws() ? !variant.records : variant.sums == SUMS_SEEN;
  const bool usual = shape.settings.tiles != TILES_ALL && shape.settings.tile_size == TILE_SIZE_DEFAULT;
  if (!plain || !usual) return "blend.comp";
  if (context.limits().subgroups_of_32) return "blend_subgroups.comp";
  return context.software() ? "blend_blocks.comp" : "blend.comp";
}

int depth_of(const FrameShape& shape) {
  if (!shape.keeps_depth()) return DEPTH_NONE;
  if (shape.settings.depth == Depth::mean) return DEPTH_MEAN;
  if (shape.settings.depth == Depth::seen) return DEPTH_SEEN;
  return !shape.canvases.empty() && shape.depth_rows == 2 ? DEPTH_MEDIAN_OF_TWO_ROWS : DEPTH_MEDIAN;
}

// Pixels that an invocation draws, one below the other, and splats whose alphas it finds at once.
struct BlendColumns {
  int height, ahead;
};

// Found by trying (README.md). With a loss blend_blocks.comp has blocks of so many rows (docs/method.md 5.2);
// without, longer columns anywhere else would cost llvmpipe more of the 65,535 rounds that it grants all
// loops. What blend.comp has at once divides BLEND_UNROLL.
BlendColumns columns_of_program(const std::string& program, const FrameShape& shape, int depth, bool is_long,
                                Size size) {
  if (program == "blend_blocks.comp") return {is_long && shape.is_lossy() ? 4 : 8, 2};
  if (is_long) return {1, 8};
  if (program != "blend_subgroups.comp") return {2, 4};
  if (shape.perspective.projection == PROJECTION_TANGENT) return {2, 3};
  return {size == Size::large && depth == DEPTH_NONE && !shape.is_lossy() ? 4 : 2, 4};
}

// Without a loss the tile test is no part of these programs: the same lists give the same bits; nor does a
// pixel's colour depend on the tiles' size. With or without, it does not on how many an invocation draws.
const gl::Program& program(gl::Context& context, const FrameShape& shape, const Variant& variant, Lists lists,
                           Size size) {
  const bool is_long = lists == Lists::of_long;
  const std::string name = name_of_program(context, shape, variant);
  const int depth = variant.draws() ? depth_of(shape) : DEPTH_NONE;
  const BlendColumns columns = columns_of_program(name, shape, depth, is_long, size);
  const bool on_canvases = variant.draws() && !shape.canvases.empty();
  gl::Defines defines = {{"TILE_SIZE", std::to_string(shape.settings.tile_size)},
                         {"SUPERTILE_SIDE", std::to_string(shape.supertile_side)},
                         {"PROBED", shape.probe ? "1" : "0"},
                         {"PARTS", shape.draws_parts() ? "1" : "0"},
                         {"LISTS", std::to_string(static_cast<int>(lists))},
                         {"COLUMN", std::to_string(columns.height)},
                         {"AHEAD", std::to_string(columns.ahead)},
                         {"HALF", shape.settings.precision == PRECISION_HALF ? "1" : "0"},
                         {"RECORDS", variant.records ? "1" : "0"},
                         {"SUMS", std::to_string(variant.sums)},
                         {"SHOW", std::to_string(variant.show)},
                         {"DEPTH", std::to_string(depth)},
                         {"LOSSY", shape.is_lossy() ? "1" : "0"},
                         {"CANVASES", std::to_string(on_canvases ? shape.canvases.size() : 0)}};
  add_projection(defines, shape.perspective.projection);
  return context.program(name, defines);
}

void run(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers, const Variant& variant,
         const gl::Buffer& measured, float scale = 0.0f) {
  gl::Context& context = dispatcher.context();
  if (variant.draws()) {
    for (std::size_t k = 0; k < shape.canvases.size(); ++k) {
      const Canvas& to = shape.canvases[k];
      context.gl().BindImageTexture(static_cast<GLuint>(k), to.texture, to.level, GL_FALSE, to.layer,
                                    GL_WRITE_ONLY, to.format);
    }
  }
  const Size size = shape.tiles_a_splat > large_tiles ? Size::large : Size::small;
  if (shape.tiles_a_splat == 0.0)
    program(context, shape, variant, Lists::of_short, Size::large);  // soon, maybe
  const auto draw = [&](Lists lists, const gl::Work& work) {
    dispatcher.start(program(context, shape, variant, lists, size), work,
                     {{"Frame", buffers.parameters},
                      {"Views", buffers.views},
                      {"PartRows", buffers.part_rows},
                      {"Ranges", buffers.ranges_of_tiles(shape)},
                      {"Values", buffers.values_of_tiles(shape)},
                      {"Splats", buffers.splats},
                      {"Colours", buffers.colours},
                      {"Canvases", buffers.canvases},
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
  if (variant.draws() && !shape.canvases.empty())
    context.gl().MemoryBarrier(GL_ALL_BARRIER_BITS);  // however the pictures are read next
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

void blend_seen(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers,
                const gl::Buffer& sums) {
  run(dispatcher, shape, buffers, {.sums = SUMS_SEEN}, sums);
}

void refuse_cut(const gl::Context& context, const shared::Counters& counters) {
  if (counters.loop_cut == 0) return;
  throw Error(ExitCode::out_of_memory,
              fmt::format("{} ended a tile's list early: too many Gaussians in one tile for this driver. "
                          "Use smaller tiles (--tile, where a picture is drawn) or a smaller model.",
                          context.renderer()));
}

}  // namespace binosplat::render
