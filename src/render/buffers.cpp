#include "render/buffers.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "base/error.h"
#include "primitives/amount.h"

namespace binosplat::render {

namespace {

// Equal to the bit in all that decides a Gaussian's depth.
bool same_depths(const shared::View& a, const shared::View& b) {
  return std::memcmp(&a.row_z, &b.row_z, sizeof(a.row_z)) == 0 &&
         std::memcmp(&a.anchor, &b.anchor, sizeof(a.anchor)) == 0;
}

}  // namespace

std::uint32_t FrameShape::list_bits() const {
  const std::uint32_t lists = settings.tiles == TILES_ALL ? view_count() : tile_count;
  return static_cast<std::uint32_t>(std::bit_width(lists - 1));
}

FrameShape make_shape(std::span<const shared::View> views, const FrameSettings& settings, const Model& model) {
  if (views.empty() || views.size() > MAX_VIEWS) fail("a frame has 1 to {} views, not {}", MAX_VIEWS, views.size());
  if (settings.tile_size != 8 && settings.tile_size != 16 && settings.tile_size != 32) {
    fail("--tile {}: expected 8, 16 or 32", settings.tile_size);
  }
  FrameShape shape;
  shape.settings = settings;
  shape.degree = model.degree;
  shape.gaussian_count = static_cast<std::uint32_t>(model.count());
  shape.views.assign(views.begin(), views.end());
  const auto tile = static_cast<std::uint32_t>(settings.tile_size);
  for (std::size_t v = 0; v < views.size(); ++v) {
    shared::View& view = shape.views[v];
    if (view.width == 0 || view.height == 0) fail("a view of {} x {} px has no picture", view.width, view.height);
    view.tiles_x = (view.width + tile - 1) / tile;
    view.tiles_y = (view.height + tile - 1) / tile;
    view.tile_offset = shape.tile_count;
    view.pixel_offset = static_cast<std::uint32_t>(shape.pixel_count);
    shape.pixel_count += std::int64_t{view.width} * view.height;
    if (shape.pixel_count > std::int64_t{1} << 31) fail("more than 2^31 pixels in one frame");
    shape.tile_count += view.tiles_x * view.tiles_y;
    if (v == 0 || !same_depths(view, shape.views[v - 1])) {
      shape.groups.push_back({static_cast<std::uint32_t>(v), static_cast<std::uint32_t>(v)});
    }
    shape.groups.back().end = static_cast<std::uint32_t>(v + 1);
    view.order_group = static_cast<std::uint32_t>(shape.groups.size() - 1);
  }
  if (std::uint64_t{shape.gaussian_count} * views.size() > std::uint64_t{1} << 32) {
    throw Error(ExitCode::out_of_memory, "more than 2^32 splats in one frame: draw fewer views at once");
  }
  return shape;
}

void ModelBuffers::upload(const Model& model) {
  std::vector<shared::Gaussian> packed(model.count());
  for (std::size_t i = 0; i < model.count(); ++i) {
    packed[i].position = glm::vec4(model.position[i], model.opacity[i]);
    packed[i].rotation = model.rotation[i];
    packed[i].scale = glm::vec4(model.scale[i], 0.0f);
  }
  gaussians.upload(packed);
  const std::size_t floats = 3 * static_cast<std::size_t>(sh_count(model.degree));
  if (floats % 4 == 0) {
    harmonics.upload(model.sh);
    return;
  }
  const std::size_t stride = (floats + 3) / 4 * 4;
  std::vector<float> padded(model.count() * stride);
  for (std::size_t i = 0; i < model.count(); ++i) {
    std::copy_n(&model.sh[i * floats], floats, &padded[i * stride]);
  }
  harmonics.upload(padded);
}

FrameBuffers::FrameBuffers(gl::Context& context)
    : views(context, "views"),
      counters(context, "counters"),
      splats(context, "splats"),
      tile_counts(context, "tile counts"),
      depth_keys(context, "depth keys"),
      block_amount(context, "amount of blocks"),
      block_counts(context, "block counts"),
      order_amounts(context, "amounts of the depth order"),
      order(context, "depth order"),
      pair_offsets(context, "pair offsets"),
      pair_amounts(context, "amounts of pairs"),
      pairs(context, "Gaussian-tile pairs"),
      ranges(context, "tile ranges"),
      colours(context, "pixels"),
      z_sums(context, "depth of pixels"),
      scan(context),
      sort(context) {}

void FrameBuffers::reserve(const FrameShape& shape, std::int64_t order_capacity, std::int64_t pair_capacity) {
  const std::int64_t gaussians = shape.gaussian_count;
  const std::int64_t splat_count = gaussians * shape.view_count();
  const std::int64_t blocks = (gaussians + COMPACT_BLOCK - 1) / COMPACT_BLOCK;
  counters.reserve(sizeof(shared::Counters));
  splats.reserve(splat_count * static_cast<std::int64_t>(sizeof(shared::Splat)));
  tile_counts.reserve(splat_count * 4);
  depth_keys.reserve(gaussians * static_cast<std::int64_t>(shape.groups.size()) * 4);
  block_counts.reserve(blocks * 4);
  order_amounts.reserve(sizeof(primitives::SortAmounts));
  order.reserve(order_capacity);
  pair_offsets.reserve(order_capacity * 4);
  pair_amounts.reserve(sizeof(primitives::SortAmounts));
  pairs.reserve(pair_capacity);
  ranges.reserve(std::max<std::int64_t>(shape.tile_count, shape.view_count()) * 8);
  colours.reserve(shape.pixel_count * 16);
  z_sums.reserve(shape.pixel_count * 4);
  scan.reserve(std::max(blocks, order_capacity));
  sort.reserve(std::max(order_capacity, pair_capacity));
}

}  // namespace binosplat::render
