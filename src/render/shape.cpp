#include "render/shape.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "render/anchors.h"
#include "render/memory.h"

namespace binosplat::render {

namespace {

// Equal to the bit in all that decides a Gaussian's depth.
bool same_depths(const shared::View& a, const shared::View& b) {
  return std::memcmp(&a.row_z, &b.row_z, sizeof(a.row_z)) == 0 &&
         std::memcmp(&a.anchor, &b.anchor, sizeof(a.anchor)) == 0;
}

// What settings need beside each other.
void check_needs(const FrameSettings& s, std::size_t views) {
  if (s.decode != DECODE_EYES && views % 2 != 0)
    fail("decode {}: only for both eyes together", decode_choices[s.decode].name);
  const DepthTable& table = s.depth_table;
  const auto is_share = [](float t) { return t >= 0.0f && t <= 1.0f; };
  if (s.transmittance == TRANSMITTANCE_DEPTH &&
      (!(table.far > 0.0f) || !std::isfinite(table.far) || table.bounds.empty() ||
       !std::all_of(table.bounds.begin(), table.bounds.end(), is_share))) {
    fail("transmittance depth: its table needs a far end above 0 and values from 0 to 1");
  }
}

// Appends a view, or a probe of it, in the last order group if that sees the same depths.
void add_view(FrameShape& shape, shared::View view, const std::optional<Probe>& probe = {}) {
  const Probe tiles = probe.value_or(Probe{});
  const auto tile = static_cast<std::uint32_t>(shape.settings.tile_size);
  const std::uint32_t v = shape.view_count();
  if (view.width == 0 || view.height == 0)
    fail("a view of {} x {} px has no picture", view.width, view.height);
  const auto tiles_in = [&](std::uint32_t pixels, std::uint32_t first) {
    const std::uint32_t all = (pixels + tile - 1) / tile;
    return all <= first ? 0 : (all - first + tiles.step - 1) / tiles.step;
  };
  view.pitch = tiles.step * tile;
  view.shift_x = tiles.column * tile;
  view.shift_y = tiles.row * tile;
  view.tiles_x = tiles_in(view.width, tiles.column);
  view.tiles_y = tiles_in(view.height, tiles.row);
  view.supertile_offset = shape.supertile_count;
  view.pixel_offset = static_cast<std::uint32_t>(shape.pixel_count);
  shape.pixel_count += probe ? std::int64_t{view.tiles_x} * view.tiles_y * tile * tile
                             : std::int64_t{view.width} * view.height;
  if (shape.pixel_count > std::int64_t{1} << 31) fail("more than 2^31 pixels in one frame");
  view.is_probe = probe ? 1 : 0;
  const auto supertiles = [side = static_cast<std::uint32_t>(shape.supertile_side)](std::uint32_t along) {
    return (along + side - 1) / side;
  };
  shape.supertile_count += supertiles(view.tiles_x) * supertiles(view.tiles_y);
  if (v == 0 || !same_depths(view, shape.views.back())) shape.groups.push_back({v, v});
  shape.groups.back().end = v + 1;
  view.order_group = static_cast<std::uint32_t>(shape.groups.size() - 1);
  shape.views.push_back(view);
}

}  // namespace

std::uint32_t FrameShape::supertile_bits() const {
  const std::uint32_t keys = settings.tiles == TILES_ALL ? view_count() : supertile_count;
  return static_cast<std::uint32_t>(std::bit_width(keys - 1));
}

void limit_keys(FrameShape& shape, const Bounds& box) {
  for (OrderGroup& group : shape.groups) {
    const shared::View& view = shape.views[group.begin];
    const glm::dvec3 anchor(view.anchor), forward(view.row_z);
    const glm::dvec3 low = glm::dvec3(box.low) - anchor, high = glm::dvec3(box.high) - anchor;
    double deepest = view.row_z.w, reach = std::abs(view.row_z.w);
    for (int k = 0; k < 3; ++k) {
      deepest += std::max(forward[k] * low[k], forward[k] * high[k]);
      reach += std::max(std::abs(low[k]), std::abs(high[k]));
    }
    const auto farthest = static_cast<float>(deepest + 1e-5 * reach);  // fp32's rounding may add to a depth
    const float near_plane = view.anchor.w;
    group.nearest_key = std::bit_cast<std::uint32_t>(near_plane);
    group.key_bits = farthest > near_plane ? static_cast<std::uint32_t>(std::bit_width(
                                                 std::bit_cast<std::uint32_t>(farthest) - group.nearest_key))
                                           : 1;
  }
}

FrameShape make_shape(std::span<const shared::View> views, const FrameSettings& settings, const Model& model,
                      int supertile_side, const std::optional<Probe>& probe) {
  if (views.empty() || views.size() > MAX_VIEWS)
    fail("a frame has 1 to {} views, not {}", MAX_VIEWS, views.size());
  check(settings);
  check_needs(settings, views.size());
  FrameShape shape;
  shape.settings = settings;
  shape.supertile_side = supertile_side;
  shape.degree = model.degree;
  shape.kernel_px2 = model.kernel_px2;
  shape.antialiased = model.antialiased;
  shape.gaussian_count = static_cast<std::uint32_t>(model.count());
  if (model.scaffold) {
    shape.offset_count = static_cast<std::uint32_t>(model.scaffold->offset_count);
    shape.views_per_decoding = settings.decode == DECODE_CYCLOPEAN ? 2 : 1;
    shape.anchor_bytes = anchor_bytes(*model.scaffold);
  }
  shape.slots = starting_slots(shape.gaussian_count);
  shape.asked = static_cast<std::uint32_t>(views.size());
  for (const shared::View& view : views) add_view(shape, view);
  shape.probe = probe;
  if (probe) add_view(shape, views[probe->view], probe);
  return shape;
}

}  // namespace binosplat::render
