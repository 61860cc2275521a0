#include "render/frame_plan.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/error.h"
#include "render/anchors.h"

namespace binosplat::render {

namespace {

// Whether all values that decide the sort keys are bit-equal.
bool same_order(const shared::View& a, const shared::View& b, Order order) {
  const auto equal = [](const glm::vec4& x, const glm::vec4& y, int size) {
    return std::memcmp(&x, &y, static_cast<std::size_t>(size)) == 0;
  };
  return equal(a.anchor, b.anchor, sizeof(a.anchor)) &&
         (order == Order::distance ? equal(a.centre, b.centre, 3 * sizeof(float))
                                   : equal(a.row_z, b.row_z, sizeof(a.row_z)));
}

void check_table(const DepthTable& table) {
  const auto is_share = [](float t) { return t >= 0.0f && t <= 1.0f; };
  if (!(table.far > 0.0f) || !std::isfinite(table.far) || table.bounds.empty() ||
      !std::all_of(table.bounds.begin(), table.bounds.end(), is_share))
    fail(
        "transmittance depth needs depth_table: take both from a calibration, or give a table with a finite "
        "`far` above 0, and `bounds` from 0 to 1");
}

// Throws Error if a setting lacks another one that it needs.
void check_needs(const FrameSettings& s, std::span<const InstancePlace> instances) {
  if (chosen_transmittance(s) != Transmittance::depth) return;
  const auto lacks_table = [](const InstancePlace& place) { return place.depth_table.bounds.empty(); };
  if (instances.empty() || std::ranges::any_of(instances, lacks_table)) check_table(s.depth_table);
  for (const InstancePlace& place : instances) {
    if (!place.depth_table.bounds.empty()) check_table(place.depth_table);
  }
}

// Adds the models. Counts each model's Gaussians once per instance.
void add_models(FramePlan& plan, std::vector<PlannedModel> models) {
  std::uint64_t count = 0, capacity = 0;
  for (const PlannedModel& model : models) {
    count += model.size.gaussians * std::uint64_t{model.instances};
    capacity += model.size.capacity * std::uint64_t{model.instances};
  }
  if (capacity > std::uint64_t{1} << 31)
    fail("{} Gaussians in all instances of the models: at most 2^31 fit a frame", capacity);
  plan.models = std::move(models);
  plan.gaussian_count = static_cast<std::uint32_t>(count);
  plan.gaussian_capacity = static_cast<std::uint32_t>(capacity);
}

bool has_partial_regions(const FrameSettings& settings) {
  return !std::all_of(settings.regions.begin(), settings.regions.end(), std::mem_fn(&ViewRegion::is_whole));
}

// Appends a view, or the probe of a view. If each point has the same depth as in the view before, joins that
// view's order group.
void add_view(FramePlan& plan, shared::View view, const ViewRegion& region,
              const std::optional<Probe>& probe = {}) {
  const Probe tiles = probe.value_or(Probe{});
  constexpr std::uint32_t tile = TILE_SIZE;
  const std::uint32_t v = plan.view_count();
  if (view.width == 0 || view.height == 0)
    fail("a view of {} x {} px has no picture", view.width, view.height);
  view.left = view.top = view.lists_shift = 0;
  plan.meshes.whole_sizes.emplace_back(view.width, view.height);
  take_window(region, view);
  view.tolerance_share = probe.has_value() == plan.exact ? region.tolerance_share : 0.0f;
  view.low_pass_share = region.low_pass_share;
  view.eye.w = view.opacity = 1.0f;
  view.table_far = plan.settings.depth_table.far;
  view.table_bins = static_cast<std::uint32_t>(plan.settings.depth_table.bounds.size());
  const auto tiles_in = [&](std::uint32_t pixels, std::uint32_t first) {
    const std::uint32_t all = (pixels + tile - 1) / tile;
    return all <= first ? 0 : (all - first + tiles.step - 1) / tiles.step;
  };
  view.pitch = tiles.step * tile;
  view.shift_x = view.left + tiles.column * tile;
  view.shift_y = view.top + tiles.row * tile;
  view.tiles_x = tiles_in(view.width, tiles.column);
  view.tiles_y = tiles_in(view.height, tiles.row);
  view.supertile_offset = plan.supertile_count;
  view.pixel_offset = static_cast<std::uint32_t>(plan.pixel_count);
  plan.pixel_count += probe ? std::int64_t{view.tiles_x} * view.tiles_y * tile * tile
                            : std::int64_t{view.width} * view.height;
  view.is_probe = probe ? 1 : 0;
  const auto supertiles = [](std::int64_t along) { return (along + SUPERTILE_SIDE - 1) / SUPERTILE_SIDE; };
  const std::int64_t supertile_count =
      plan.supertile_count + supertiles(view.tiles_x) * supertiles(view.tiles_y);
  if (supertile_count > 1 << 20) fail("more than 2^30 pixels in one frame");  // supertiles.glsl needs it
  plan.supertile_count = static_cast<std::uint32_t>(supertile_count);
  if (v == 0 || !same_order(view, plan.views.back(), plan.perspective.order)) plan.groups.push_back({v, v});
  plan.groups.back().end = v + 1;
  if (has_partial_regions(plan.settings)) {
    check_region(region, v, {view.width, view.height});
    const auto rows = region_rows(region, view, {tiles.column, tiles.row}, tiles.step);
    view.first_row = static_cast<std::uint32_t>(plan.region_rows.size());
    plan.region_rows.insert(plan.region_rows.end(), rows.begin(), rows.end());
  }
  view.order_group = static_cast<std::uint32_t>(plan.groups.size() - 1);
  plan.views.push_back(view);
}

// Returns the disparity of objects at this depth in two parallel views, in columns of supertiles. A negative
// disparity wraps around, so the result lies from 0 up to the number of columns.
std::uint32_t disparity(const shared::View& first, const shared::View& second, double depth) {
  if (!(depth > 0.0)) return 0;
  const auto across = static_cast<int>((first.tiles_x + SUPERTILE_SIDE - 1) / SUPERTILE_SIDE);
  const auto centre = [](const shared::View& v) { return double{v.lens.z} - v.shift_x; };  // px in its grid
  const double apart = double{first.row_x.w} - second.row_x.w;
  const double pixels = centre(first) - centre(second) + first.lens.x * apart / depth;
  const double columns = std::round(pixels / (SUPERTILE_SIDE * TILE_SIZE));
  return std::abs(columns) < across ? static_cast<std::uint32_t>(columns < 0.0 ? columns + across : columns)
                                    : 0;
}

}  // namespace

void share_lists(FramePlan& plan, std::int64_t slots, double middle_depth) {
  constexpr std::int64_t splats_max = std::int64_t{1} << (32 - 2 * SUPERTILE_SIDE * SUPERTILE_SIDE);
  const std::int64_t firsts_end = (plan.view_count() - 1) | 1;  // views whose splats the lists store
  plan.list_views =
      plan.requested_views >= 2 && slots * firsts_end <= splats_max && plan.settings.tiles != TILES_ALL ? 2
                                                                                                        : 1;
  for (std::size_t v = 0; v + 1 < plan.view_count(); v += 2) {
    const shared::View &first = plan.views[v], &second = plan.views[v + 1];
    if (first.order_group != second.order_group || first.tiles_x != second.tiles_x ||
        first.tiles_x <= SUPERTILE_SIDE || first.tiles_y != second.tiles_y ||
        first.is_probe != second.is_probe || first.lens.x != second.lens.x || first.lens.y != second.lens.y)
      plan.list_views = 1;
  }
  for (std::size_t v = 0; v < plan.view_count(); ++v) {
    plan.views[v].lists_shift =
        plan.list_views == 2 && v % 2 == 1 ? disparity(plan.views[v - 1], plan.views[v], middle_depth) : 0;
  }
}

int FramePlan::depth() const {
  if (visibility_as_depth) return DEPTH_VISIBILITY;
  if (!settings.has_depths) return DEPTH_NONE;
  if (settings.depth == DepthKind::mean) return DEPTH_MEAN;
  return !canvases.empty() && depth_rows == 2 && !has_discs() ? DEPTH_MEDIAN_OF_TWO_ROWS : DEPTH_MEDIAN;
}

bool FramePlan::has_discs() const {
  return settings.has_depths && settings.precision == PRECISION_FULL && !visibility_as_depth &&
         !between_pixels && std::ranges::any_of(models, &PlannedModel::flat);
}

bool FramePlan::has_broad_tiles() const {
  const auto is_broad = [](const shared::View& view) {
    return std::min(view.lens.x, view.lens.y) < 2.0f * TILE_SIZE;
  };
  return perspective.projection == Projection::tangent && std::ranges::any_of(views, is_broad);
}

// Lists are sorted by z, or by the distance from `centre`. No eye is farther than `farthest` from `centre`.
// So, measured from an eye, a splat may be nearer than its predecessor by up to twice `farthest`.
float FramePlan::depth_slack() const {
  if (perspective.order == Order::depth && perspective.projection == Projection::affine) return 0.0f;
  if (perspective.order != Order::distance || perspective.projection != Projection::tangent)
    return std::numeric_limits<float>::infinity();
  float farthest = 0.0f;
  for (const shared::View& view : views)
    farthest = std::max(farthest, glm::length(glm::vec3(view.eye) - glm::vec3(view.centre)));
  return 2.001f * farthest;
}

Perspective perspective_of(const FrameSettings& settings, const Model& model) {
  return {settings.order.value_or(model.perspective.order),
          settings.projection.value_or(model.perspective.projection)};
}

PlannedModel planned(const Model& model, const ModelSize& size) {
  return {.degree = model.degree,
          .kernel_px2 = model.kernel_px2,
          .antialiased = model.antialiased,
          .linear = model.linear,
          .flat = model.flat,
          .size = size};
}

FramePlan make_plan(std::span<const shared::View> views, const FrameSettings& settings, const Model& model,
                    const ModelSize& size, const DebugOptions& debug, const PlanRequest& request) {
  if (views.empty() || views.size() > MAX_VIEWS)
    fail("a frame has 1 to {} views, not {}", MAX_VIEWS, views.size());
  check_needs(settings, request.instances);
  check_regions(settings, views.size(), model.scaffold != nullptr);
  FramePlan plan;
  plan.settings = settings;
  plan.settings.threshold = request.threshold.value_or(chosen_threshold(settings));
  plan.settings.transmittance = chosen_transmittance(plan.settings);
  plan.tolerance = request.tolerance.value_or(settings.tolerance.value_or(0.0f));
  plan.exact = request.exact;
  if (plan.exact && !request.probe) {
    plan.settings.threshold = Threshold::exact;
    plan.settings.quality.reset();
  }
  plan.between_pixels = debug.between_pixels;
  plan.visibility_as_depth = debug.visibility_as_depth;
  plan.perspective = perspective_of(settings, model);
  plan.instances = request.instances;
  add_models(plan, request.models.empty() ? std::vector{planned(model, size)} : request.models);
  if (model.scaffold) {
    plan.offset_count = static_cast<std::uint32_t>(model.scaffold->offset_count);
    plan.anchor_bytes = anchor_bytes(*model.scaffold);
  }
  plan.requested_views = static_cast<std::uint32_t>(views.size());
  const CallersTextures& textures = request.textures;
  plan.canvases.assign(textures.canvases.begin(), textures.canvases.end());
  plan.depth_rows = textures.depth_rows;
  plan.meshes.depths.assign(textures.mesh_depths.begin(), textures.mesh_depths.end());
  const auto region_of = [&](std::size_t v) {
    return settings.regions.empty() ? ViewRegion{} : settings.regions[v];
  };
  for (std::size_t v = 0; v < views.size(); ++v) add_view(plan, views[v], region_of(v));
  plan.probe = request.probe;
  if (const auto& probe = plan.probe) {
    if (region_of(probe->view).is_window()) fail("a probe of a window: expected a whole view");
    add_view(plan, views[probe->view], region_of(probe->view), probe);
  }
  return plan;
}

}  // namespace binosplat::render
