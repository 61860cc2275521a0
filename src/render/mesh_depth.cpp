// Before the blend: how far each pixel is seen, where meshes stand in it.

#include <bit>

#include "render/stages.h"
#include "render/variants.h"

namespace binosplat::render {

namespace {

std::uint32_t bits_of(float number) { return std::bit_cast<std::uint32_t>(number); }

// Tiles of the supertiles of a view: those up to the next view's first.
std::uint32_t tiles_of(const FramePlan& plan, std::uint32_t v) {
  const std::uint32_t end =
      v + 1 < plan.view_count() ? plan.views[v + 1].supertile_offset : plan.supertile_count;
  return (end - plan.views[v].supertile_offset) * plan.tiles_a_supertile();
}

}  // namespace

void read_mesh_depths(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers) {
  if (plan.mesh_depths.empty()) return;
  gl::Context& context = dispatcher.context();
  for (std::uint32_t v = 0; v < plan.view_count(); ++v) {
    const MeshDepth& from = plan.mesh_depths[v < plan.asked ? v : plan.probe->view];
    const MeshVariant variant(plan, from.layer >= 0);
    context.gl().BindTextureUnit(MAX_CANVASES, from.texture);
    context.gl().BindSampler(MAX_CANVASES, buffers.nearest.id());
    dispatcher.start(context.program("mesh_depth.comp", variant),
                     gl::DispatchSize::of_groups(tiles_of(plan, v)),
                     {{"Frame", buffers.parameters},
                      {"Views", buffers.views},
                      {"RegionRows", buffers.region_rows},
                      {"MeshDepths", buffers.pictures.mesh_depths}},
                     {{"view_index", v},
                      {"view_tiles", tiles_of(plan, v)},
                      {"whole_width", plan.whole_sizes[v].x},
                      {"whole_height", plan.whole_sizes[v].y},
                      {"left", static_cast<std::uint32_t>(from.x)},
                      {"bottom", static_cast<std::uint32_t>(from.y)},
                      {"columns", static_cast<std::uint32_t>(from.size.x)},
                      {"rows", static_cast<std::uint32_t>(from.size.y)},
                      {"level", static_cast<std::uint32_t>(from.level)},
                      {"layer", static_cast<std::uint32_t>(std::max(from.layer, 0))},
                      {"is_inverse", from.is_inverse ? 1u : 0u},
                      {"scale", bits_of(from.scale)},
                      {"offset", bits_of(from.offset)},
                      {"nothing", bits_of(from.nothing)}});
  }
  dispatcher.wait_for_writes();
}

}  // namespace binosplat::render
