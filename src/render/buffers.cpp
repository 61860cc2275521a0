#include "render/buffers.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "primitives/arguments.h"
#include "render/halves.h"

namespace binosplat::render {

namespace {

shared::FrameParameters parameters_of(const FrameShape& shape) {
  const FrameSettings& s = shape.settings;
  return {.background = glm::vec4(s.background, 0.0f),
          .tolerance = s.tolerance,
          .far = s.depth_table.far,
          .depth_bins = static_cast<std::uint32_t>(s.depth_table.bounds.size()),
          .remembers = shape.remembers,
          .view_count = shape.view_count(),
          .asked = shape.asked,
          .probed = shape.probe ? shape.probe->view : MAX_VIEWS,
          .gaussian_count = shape.gaussian_count,
          .slots = shape.slots,
          .tile_count = shape.tile_count(),
          .list_per_view = s.tiles == TILES_ALL,
          .offset_count = shape.offset_count,
          .views_per_decoding = shape.views_per_decoding,
          .decoding_of_probe = shape.decoding_of_probe(),
          .anchor_cull = s.anchor_cull,
          .unused = 0};
}

}  // namespace

FrameBuffers::FrameBuffers(gl::Context& context)
    : parameters(context, "parameters of the frame"),
      views(context, "views"),
      part_rows(context, "parts of views"),
      counters(context, "counters"),
      depth_keys(context, "depth keys"),
      block_arguments(context, "arguments of blocks"),
      block_counts(context, "block counts"),
      order(context, "depth order"),
      pair_offsets(context, "pair offsets"),
      bounds(std::make_unique<gl::Buffer>(context, "remembered transmittance")),
      next_bounds(std::make_unique<gl::Buffer>(context, "transmittance to remember")),
      measured(context, "measured transmittance"),
      depth_table(context, "transmittance by depth"),
      splats(context, "splats"),
      coverages(context, "tile coverage"),
      tall(context, "tall splats"),
      pair_arguments(context, "arguments of pairs"),
      pairs(context, "Gaussian-tile pairs"),
      ranges(context, "ranges of supertiles"),
      tile_counts(context, "tiles' counts"),
      tile_ranges(context, "ranges of tiles"),
      tile_values(context, "lists of tiles"),
      long_lists(context, "tiles with long lists"),
      canvases(context, "canvases"),
      colours(context, "pixels"),
      z_sums(context, "depth of pixels"),
      shown(context, "what the blend comes by"),
      shown_light(context, "transmittance to show"),
      scan(context),
      sort(context),
      look_back(context),
      context_(context) {}

void FrameBuffers::upload(const FrameShape& shape) {
  parameters.upload(std::vector{parameters_of(shape)});
  views.upload(shape.views);
  std::vector<shared::Canvas> of_views;
  for (const Canvas& canvas : shape.canvases) of_views.push_back(on_gpu(canvas));
  if (!of_views.empty()) canvases.upload(of_views);
  if (shape.draws_parts()) part_rows.upload(shape.part_rows);
  if (shape.settings.transmittance != TRANSMITTANCE_DEPTH) return;
  std::vector<float> table = shape.settings.depth_table.bounds;
  for (float& bound : table) bound = bound > 0.0f ? std::max(bound, static_cast<float>(BOUND_FLOOR)) : 1.0f;
  depth_table.upload(table);
}

void FrameBuffers::reserve(const FrameShape& shape, const ModelBuffers& model, std::int64_t pair_capacity,
                           std::int64_t tile_pair_capacity) {
  const std::int64_t gaussians = shape.gaussian_room;
  const std::int64_t slots = shape.slots;
  const std::int64_t blocks = (gaussians + COMPACT_BLOCK - 1) / COMPACT_BLOCK;
  counters.reserve(sizeof(shared::Counters));
  depth_keys.reserve(gaussians * 4);
  block_counts.reserve(blocks * 4);
  while (drawn.size() < shape.groups.size()) drawn.push_back(std::make_unique<DrawnBuffers>(context_));
  for (const auto& group : drawn) {
    group->arguments.reserve(sizeof(primitives::SortArguments));
    group->indices.reserve(slots * 4);
  }
  if (measures(shape.settings.transmittance)) {
    bounds->reserve(gaussians * shape.asked * 4);
    next_bounds->reserve(gaussians * shape.asked * 4);
    measured.reserve(slots * shape.view_count() * 4);
  }
  for (std::size_t page = 0; shape.offset_count > 0 && page < model.pages.size(); ++page) {
    for (auto* each : {&kept, &kept_last}) {
      if (page == each->size())
        each->push_back(std::make_unique<gl::Buffer>(context_, "Gaussians kept by anchor"));
      (*each)[page]->reserve(std::int64_t{shape.decoding_count()} * model.pages[page].anchors->count * 4);
    }
  }
  order.reserve(slots);
  pair_offsets.reserve(slots * 4);
  splats.reserve(slots * shape.view_count() * splat_bytes(shape.settings.precision));
  coverages.reserve(slots * shape.view_count() * 4);
  tall.reserve(slots * shape.view_count() * 4);
  pair_arguments.reserve(4 * sizeof(shared::DispatchArguments));
  pairs.reserve(pair_capacity);
  ranges.reserve(std::max<std::int64_t>(shape.supertile_count, shape.view_count()) * 8);
  if (shape.supertile_side > 1) {
    const std::int64_t blocks_of_pairs = (pairs.capacity() + TILE_BLOCK - 1) / TILE_BLOCK;
    const std::int64_t counts = blocks_of_pairs * shape.tiles_a_supertile();
    tile_counts.reserve(counts * 4);
    scan.reserve(counts);
    tile_ranges.reserve(shape.tile_count() * 8LL);
    tile_values.reserve(tile_pair_capacity * 4);
  }
  long_lists.reserve(shape.tile_count() * 4LL);
  if (shape.canvases.empty()) colours.reserve(shape.pixel_count * 16);
  if (shape.keeps_depth()) z_sums.reserve(shape.pixel_count * 4);
  scan.reserve(std::max(blocks, slots));
  look_back.reserve(std::max(blocks, slots / SCAN_BLOCK) + 1);
  for (const OrderGroup& group : shape.groups) sort.reserve(order, group.key_bits);
  sort.reserve(pairs, shape.supertile_bits());
}

std::vector<DrawnGaussian> FrameBuffers::read_drawn(const FrameShape& shape, std::uint32_t v) const {
  const DrawnBuffers& of_group = *drawn[shape.views.at(v).order_group];
  const std::uint32_t count = of_group.arguments.read<shared::DispatchArguments>(1).front().count;
  const auto indices = of_group.indices.read<std::uint32_t>(count);
  const std::size_t view_count = shape.view_count();
  const auto covers = coverages.read<std::uint32_t>(count * view_count);
  std::vector<DrawnGaussian> found;
  for (std::uint32_t slot = 0; slot < count; ++slot) {
    if (covers[slot * view_count + v] != 0) found.push_back({indices[slot], slot});
  }
  return found;
}

void FrameBuffers::keep_last(const FrameShape& shape) {
  if (shape.records) std::swap(bounds, next_bounds);
  std::swap(kept, kept_last);
}

}  // namespace binosplat::render
