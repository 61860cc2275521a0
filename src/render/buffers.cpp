#include "render/buffers.h"

#include <algorithm>

#include "render/halves.h"

namespace binosplat::render {

namespace {

shared::FrameParameters parameters_of(const FramePlan& plan, std::uint32_t slots, bool uses_measured) {
  const FrameSettings& s = plan.settings;
  return {.background =
              glm::vec4(s.background.value_or(glm::vec3(0.0f)), plan.models.front().linear ? 1.0f : 0.0f),
          .tolerance = plan.tolerance,
          .has_bounds = uses_measured,
          .view_count = plan.view_count(),
          .requested_views = plan.requested_views,
          .probed_view = plan.probe ? plan.probe->view : MAX_VIEWS,
          .gaussian_count = plan.gaussian_count,
          .slots = slots,
          .list_per_view = s.tiles == TILES_ALL,
          .has_regions = plan.draws_regions(),
          .has_broad_tiles = plan.has_broad_tiles(),
          .offset_count = plan.offset_count,
          .anchor_cull = s.anchor_cull,
          .depth_slack = plan.depth_slack()};
}

}  // namespace

FrameBuffers::FrameBuffers(gl::Context& context)
    : parameters(context, "parameters of the frame"),
      views(context, "views"),
      instance_views(context, "views of instances"),
      region_rows(context, "regions of views"),
      counters(context, "counters"),
      transmittance{.depth_tables = {context, "transmittance by depth"},
                    .bounds = std::make_unique<gl::Buffer>(context, "measured transmittance"),
                    .next_bounds = std::make_unique<gl::Buffer>(context, "transmittance for the next frame"),
                    .measured = {context, "transmittance by splat"}},
      culled{.depth_keys = {context, "depth keys"}, .block_counts = {context, "block counts"}},
      projected{.depths = {context, "depths"},
                .splats = {context, "splats"},
                .discs = {context, "planes of flat Gaussians"},
                .coverages = {context, "tile coverage"},
                .large = {context, "large splats"}},
      lists{.entries = {context, "Gaussian-supertile pairs"},
            .supertile_counts = {context, "counts of supertiles"},
            .supertile_ends = {context, "ends of supertiles"},
            .items = {context, "lists to be sorted"},
            .slab_tiles = {context, "tiles of split lists"},
            .tile_ranges = {context, "ranges of tiles"},
            .tile_values = {context, "lists of tiles"},
            .long_lists = {context, "tiles with long lists"}},
      pictures{.canvases = {context, "canvases"},
               .colours = {context, "pixels"},
               .z_sums = {context, "depth of pixels"},
               .unfinished = {context, "unfinished pixels"},
               .mesh_sources = {context, "sources of mesh depths"},
               .debug_values = {context, "debug view"},
               .debug_transmittance = {context, "transmittance of a debug view"}},
      nearest(context),
      look_back(context),
      context_(context) {}

void FrameBuffers::upload(const FramePlan& plan, bool uses_measured) {
  parameters.upload(std::vector{parameters_of(plan, slots, uses_measured)});
  views.upload(plan.views);
  std::vector<shared::Canvas> of_views;
  for (const Canvas& canvas : plan.canvases) of_views.push_back(on_gpu(canvas));
  if (!of_views.empty()) pictures.canvases.upload(of_views);
  std::vector<shared::MeshSource> meshes;
  for (std::size_t v = 0; v < plan.meshes.depths.size(); ++v)
    meshes.push_back(on_gpu(plan.meshes.depths[v], plan.meshes.whole_sizes[v]));
  if (!meshes.empty()) pictures.mesh_sources.upload(meshes);
  region_rows.reserve(sizeof(glm::uvec2));  // bound even in programs that never read it
  if (plan.draws_regions()) region_rows.upload(plan.region_rows);
  const bool by_depth = plan.settings.transmittance == Transmittance::depth;
  std::vector<float> tables;
  if (by_depth) tables = plan.settings.depth_table.bounds;
  std::vector<shared::View> of_instances;
  for (const InstancePlace& place : plan.instances) {
    const DepthTable& own = place.depth_table;
    for (const shared::View& view : plan.views) {
      shared::View& seen = of_instances.emplace_back(view_of_instance(view, place));
      if (!by_depth || own.bounds.empty()) continue;
      seen.table_far = static_cast<float>(own.far * place.scale);
      seen.table_first = static_cast<std::uint32_t>(tables.size());
      seen.table_bins = static_cast<std::uint32_t>(own.bounds.size());
    }
    if (by_depth) tables.insert(tables.end(), own.bounds.begin(), own.bounds.end());
  }
  if (!of_instances.empty()) instance_views.upload(of_instances);
  if (!by_depth) return;
  for (float& bound : tables)
    bound = bound > 0.0f ? std::max(bound, static_cast<float>(TRANSMITTANCE_MIN)) : 1.0f;
  if (tables.empty()) tables.push_back(1.0f);  // a bound buffer must not be empty
  transmittance.depth_tables.upload(tables);
}

void FrameBuffers::reserve(const FramePlan& plan, std::span<const std::shared_ptr<ModelBuffers>> models,
                           const Capacity& capacity) {
  const std::int64_t gaussians = plan.gaussian_capacity;
  slots = static_cast<std::uint32_t>(capacity.slots);
  const std::int64_t blocks = (gaussians + COMPACT_BLOCK - 1) / COMPACT_BLOCK;
  counters.reserve(sizeof(shared::Counters));
  culled.depth_keys.reserve(gaussians * 4);
  culled.block_counts.reserve(blocks * 4);
  while (drawn.size() < plan.groups.size()) drawn.push_back(std::make_unique<DrawnBuffers>(context_));
  for (const auto& group : drawn) {
    group->arguments.reserve(sizeof(shared::DispatchArguments));
    group->indices.reserve(capacity.slots * 4);
  }
  if (measures(plan.settings)) {
    transmittance.bounds->reserve(gaussians * plan.requested_views * 4);
    transmittance.next_bounds->reserve(gaussians * plan.requested_views * 4);
    transmittance.measured.reserve(capacity.slots * plan.view_count() * 4);
  }
  for (std::size_t page = 0; plan.offset_count > 0 && page < models.front()->pages.size(); ++page) {
    if (page == kept.size())
      kept.push_back(std::make_unique<gl::Buffer>(context_, "Gaussians kept by anchor"));
    kept[page]->reserve(std::int64_t{plan.requested_views} * models.front()->pages[page].anchors->count * 4);
  }
  const std::int64_t splats = capacity.slots * plan.view_count();
  projected.depths.reserve(capacity.slots * static_cast<std::int64_t>(plan.groups.size()) * 4);
  projected.splats.reserve(splats * splat_bytes(plan.settings.precision));
  if (plan.has_discs()) projected.discs.reserve(splats * 16);
  projected.coverages.reserve(splats * 4);
  projected.large.reserve(splats * 4);
  lists.large_offset = static_cast<std::uint32_t>(capacity.pairs);
  // Splitting long lists copies each entry to a second place.
  const std::int64_t behind =
      capacity.rounds > 0 ? std::max(capacity.large_pairs, capacity.pairs) : capacity.large_pairs;
  lists.entries.reserve((capacity.pairs + behind) * 8);
  if (const std::int64_t bytes = plan.supertile_count * 4LL; lists.supertile_counts.bytes() < bytes)
    lists.supertile_counts.reserve_zeros(bytes);
  lists.supertile_ends.reserve(plan.supertile_count * 4LL);
  lists.item_capacity =
      plan.supertile_count + static_cast<std::uint32_t>(capacity.rounds * capacity.pairs / (SORT_MAX / 4));
  lists.items.reserve(std::int64_t{SORT_LONG_KIND + capacity.rounds} * lists.item_capacity * 16);
  lists.slab_tiles.reserve(
      std::max<std::int64_t>(1, capacity.rounds * capacity.pairs / SORT_MAX * SORT_SLABS) * 32);
  lists.tile_ranges.reserve(plan.tile_count() * 8LL);
  pictures.unfinished.reserve(plan.list_parts > 1 ? plan.pixel_count * 32 : 32);
  lists.tile_values.reserve(capacity.tile_pairs * 4);
  lists.long_lists.reserve(plan.tile_count() * 4LL);
  if (plan.canvases.empty()) pictures.colours.reserve(plan.pixel_count * 16);
  if (plan.depth() != DEPTH_NONE) pictures.z_sums.reserve(plan.pixel_count * 4);
  look_back.reserve(blocks + 1);
}

std::vector<DrawnGaussian> FrameBuffers::read_drawn(const FramePlan& plan, std::uint32_t v) const {
  const DrawnBuffers& of_group = *drawn[plan.views.at(v).order_group];
  const std::uint32_t count = of_group.arguments.read<shared::DispatchArguments>(1).front().count;
  const auto indices = of_group.indices.read<std::uint32_t>(count);
  const auto covers = projected.coverages.read<std::uint32_t>(count, std::size_t{v} * slots);
  std::vector<DrawnGaussian> found;
  for (std::uint32_t slot = 0; slot < count; ++slot) {
    if (covers[slot] != 0) found.push_back({indices[slot], slot});
  }
  return found;
}

void FrameBuffers::swap_bounds(bool measured_now) {
  if (measured_now) std::swap(transmittance.bounds, transmittance.next_bounds);
}

}  // namespace binosplat::render
