#include "measure/reference_stages.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "base/error.h"
#include "reference/adagscale_threshold.h"
#include "reference/render.h"
#include "render/buffers.h"
#include "render/halves.h"

namespace binosplat::measure {

namespace {

using render::FrameBuffers;
using render::FramePlan;
using render::FrameSettings;
using render::ModelBuffers;
using render::OrderGroup;
using render::Stage;

// Stores a cone as shaders/projection/tangent.glsl does: signs mark wide splats and means behind the eye.
void keep_cone(const reference::Splat& s, shared::Splat& out) {
  const glm::dmat2 q(s.cone->form);
  out.conic = glm::vec4(glm::dvec4(q[0][0], q[0][1], q[1][1], 1 / std::sqrt(glm::determinant(q))));
  if (!reference::is_wide(*s.cone)) return;
  out.depth = -out.depth;
  if (s.cone->is_behind) out.conic.w = -out.conic.w;
}

shared::Splat to_shared(const reference::Splat& s) {
  shared::Splat out{};
  out.mean = glm::vec2(s.mean);
  out.depth = static_cast<float>(s.depth);
  out.opacity = static_cast<float>(s.opacity);
  out.conic = glm::vec4(glm::dvec4(s.conic, std::sqrt(s.det)));
  if (s.cone) keep_cone(s, out);
  out.colour = glm::vec4(glm::dvec4(s.colour, 2.0 * std::log(s.opacity / s.threshold)));
  return out;
}

reference::Settings reference_settings(const FramePlan& plan) {
  const FrameSettings& s = plan.settings;
  return {.tiles = s.tiles,
          .threshold = *s.threshold,
          .tolerance = plan.tolerance,
          .anchor_cull = s.anchor_cull,
          .perspective = plan.perspective};
}

template <typename T>
void upload_in(int precision, const std::vector<T>& things, gl::Buffer& buffer) {
  if (precision == PRECISION_FULL) return buffer.upload(things);
  std::vector<render::Halves> packed;
  for (const T& thing : things) packed.push_back(render::pack(thing));
  buffer.upload(packed);
}

void upload_harmonics(int precision, const std::vector<glm::vec4>& harmonics, gl::Buffer& buffer) {
  if (precision == PRECISION_FULL) return buffer.upload(harmonics);
  std::vector<std::uint32_t> packed(4 * harmonics.size());
  for (std::size_t k = 0; k < harmonics.size(); ++k)
    render::pack(std::span(&harmonics[k].x, 4), std::span(packed).subspan(4 * k, 4));
  buffer.upload(packed);
}

// One decoding of a page: the outputs of the stage decode.
struct DecodedPage {
  std::vector<shared::Gaussian> gaussians;
  std::vector<glm::vec4> harmonics;
  std::vector<std::uint32_t> kept;
};

void add(const reference::Decoded& decoded, std::size_t place, std::size_t offset_count, DecodedPage& page) {
  const reference::Gaussian& g = decoded.gaussian;
  page.gaussians[place] = {glm::vec4(glm::dvec4(g.position, g.opacity)), glm::vec4(g.rotation),
                           glm::vec4(glm::dvec4(g.scale, 0.0))};
  page.harmonics[place] = glm::vec4(glm::dvec4((decoded.colour - 0.5) / sh_c0, 0.0));
  page.kept[place / offset_count] |= 1u << place % offset_count;
}

void upload_decoded(const Model& model, const FramePlan& plan, ModelBuffers& model_buffers,
                    FrameBuffers& buffers) {
  if (!model.scaffold) fail("reference until decode: {} is not a Scaffold-GS model", model.name);
  std::vector<std::vector<reference::Decoded>> decodings;
  for (std::uint32_t v = 0; v < plan.requested_views; ++v)
    decodings.push_back(reference::decode(*model.scaffold, plan.views[v], plan.settings.anchor_cull));
  for (std::size_t p = 0; p < model_buffers.pages.size(); ++p) {
    ModelBuffers::Page& page = model_buffers.pages[p];
    const std::size_t all = decodings.size() * page.count;
    DecodedPage decoded{std::vector<shared::Gaussian>(all), std::vector<glm::vec4>(all),
                        std::vector<std::uint32_t>(all / plan.offset_count)};
    for (std::size_t d = 0; d < decodings.size(); ++d) {
      for (const reference::Decoded& one : decodings[d]) {
        if (one.id < page.first || one.id - page.first >= page.count) continue;
        add(one, d * page.count + one.id - page.first, plan.offset_count, decoded);
      }
    }
    upload_in(plan.settings.precision, decoded.gaussians, *page.gaussians);
    upload_harmonics(plan.settings.precision, decoded.harmonics, *page.harmonics);
    buffers.kept[p]->upload(decoded.kept);
  }
}

struct ViewResult {
  std::vector<reference::Splat> splats;
  reference::TileLists lists;
  std::vector<std::uint32_t> pair_counts;
};

ViewResult reference_view(const Model& model, const FramePlan& plan, std::uint32_t v) {
  const shared::View& view = plan.views[v];
  const FrameSettings& settings = plan.settings;
  ViewResult result;
  result.splats = reference::project_all(model, view, settings.anchor_cull, plan.perspective);
  reference::set_thresholds(result.splats, *settings.threshold, plan.tolerance);
  const std::vector<std::uint32_t> order = reference::depth_order(result.splats);
  if (settings.tiles == TILES_ALL) {
    // All tiles of the view share one list, as on the GPU.
    result.lists = {1, 1, {0, static_cast<std::uint32_t>(order.size())}, order};
  } else {
    result.lists = reference::make_lists(result.splats, order, view, settings.tiles);
  }
  result.pair_counts.resize(model.count());
  for (const std::uint32_t i : result.lists.gaussians) ++result.pair_counts[i];
  return result;
}

// The Gaussians that an order group draws, in index order, and the slot of each.
struct Slots {
  std::vector<std::uint32_t> indices;
  std::vector<std::uint32_t> of;  // slot of each Gaussian; valid only for Gaussians in `indices`
};

Slots make_slots(const FramePlan& plan, OrderGroup group, const std::vector<ViewResult>& results) {
  Slots slots;
  slots.of.resize(plan.gaussian_count);
  for (std::uint32_t i = 0; i < plan.gaussian_count; ++i) {
    const auto draws = [&](const ViewResult& r) { return r.pair_counts[i] > 0; };
    if (!std::any_of(results.begin() + group.begin, results.begin() + group.end, draws)) continue;
    slots.of[i] = static_cast<std::uint32_t>(slots.indices.size());
    slots.indices.push_back(i);
  }
  return slots;
}

using Entry = glm::uvec2;  // bits of the depth, then splat and tiles (supertiles.glsl)

// The entries of each supertile, front to back.
using Supertiles = std::vector<std::vector<Entry>>;

Supertiles entries_of(const FramePlan& plan, const std::vector<Slots>& slots,
                      const std::vector<ViewResult>& results, std::uint32_t slots_a_view) {
  Supertiles supertiles(plan.supertile_count);
  for (std::uint32_t v = 0; v < plan.view_count(); ++v) {
    const shared::View& view = plan.views[v];
    const reference::TileLists& lists = results[v].lists;
    const std::vector<std::uint32_t> order = reference::depth_order(results[v].splats);
    std::vector<std::uint32_t> rank(plan.gaussian_count);
    for (std::uint32_t r = 0; r < order.size(); ++r) rank[order[r]] = r;
    const std::uint32_t side = SUPERTILE_SIDE, across = (lists.tiles_x + side - 1) / side;
    std::vector<std::map<std::uint32_t, Entry>> found(plan.supertiles_of(v));  // by place in `order`
    for (std::uint32_t t = 0; t + 1 < lists.begin.size(); ++t) {
      const std::uint32_t x = t % lists.tiles_x, y = t / lists.tiles_x;
      for (std::uint32_t k = lists.begin[t]; k < lists.begin[t + 1]; ++k) {
        const std::uint32_t i = lists.gaussians[k], splat = v * slots_a_view + slots[view.order_group].of[i];
        Entry& entry = found[y / side * across + x / side][rank[i]];
        entry.x = std::bit_cast<std::uint32_t>(static_cast<float>(results[v].splats[i].order));
        entry.y |= splat << side * side | 1u << (y % side * side + x % side);
      }
    }
    for (std::uint32_t n = 0; n < found.size(); ++n)
      for (const auto& [_, entry] : found[n]) supertiles[view.supertile_offset + n].push_back(entry);
  }
  return supertiles;
}

// Uploads the outputs of the stage bin: entries, and an item for each list to sort (sort_items.glsl).
void upload_entries(const Supertiles& supertiles, FrameBuffers& buffers) {
  std::vector<Entry> entries;
  shared::Counters counters{};
  std::vector<glm::uvec4> items(std::size_t{SORT_CLASSES} * buffers.lists.item_capacity);
  for (std::uint32_t s = 0; s < supertiles.size(); ++s) {
    const auto length = static_cast<std::uint32_t>(supertiles[s].size());
    if (length == 0) continue;
    if (length > SORT_MAX)
      fail("reference until bin: a supertile lists {} Gaussians; at most {} fit", length, SORT_MAX);
    const int bits = std::bit_width(length - 1) - std::bit_width(32u * SORT_EACH - 1);
    const auto kind = static_cast<std::uint32_t>(std::max(bits, 0));
    shared::ListCount& lists = counters.lists[kind];
    items[std::size_t{kind} * buffers.lists.item_capacity + lists.count++] = {
        s, static_cast<std::uint32_t>(entries.size()), length, NO_SECOND};
    lists.groups_x = std::min(lists.count, SORT_GROUPS_MAX);
    lists.groups_y = lists.groups_z = 1;
    entries.insert(entries.end(), supertiles[s].begin(), supertiles[s].end());
  }
  counters.pairs = static_cast<std::uint32_t>(entries.size());
  buffers.lists.entries.reserve(static_cast<std::int64_t>(entries.size() * sizeof(Entry)));
  buffers.lists.entries.upload(entries);
  buffers.lists.items.upload(items);
  buffers.lists.tile_ranges.reserve_zeros(buffers.lists.tile_ranges.bytes());
  buffers.counters.upload(std::vector{counters});
}

// Uploads the outputs of the stage sort: the tiles' lists.
void upload_lists(const FramePlan& plan, const Supertiles& supertiles, FrameBuffers& buffers) {
  std::vector<glm::uvec2> ranges;
  std::vector<std::uint32_t> values;
  for (const std::vector<Entry>& entries : supertiles) {
    for (std::uint32_t tile = 0; tile < SUPERTILE_SIDE * SUPERTILE_SIDE; ++tile) {
      const std::size_t begin = values.size();
      for (const Entry& entry : entries) {
        if ((entry.y >> tile & 1) != 0) values.push_back(entry.y >> SUPERTILE_SIDE * SUPERTILE_SIDE);
      }
      ranges.emplace_back(begin, values.size());
    }
  }
  std::vector<std::uint32_t> long_lists;
  for (std::uint32_t tile = 0; tile < ranges.size() && plan.settings.tiles != TILES_ALL; ++tile)
    if (ranges[tile].y - ranges[tile].x > LONG_LIST) long_lists.push_back(tile);
  const auto count = static_cast<std::uint32_t>(long_lists.size());
  buffers.counters.upload(
      std::vector{shared::Counters{.tile_pairs = static_cast<std::uint32_t>(values.size()),
                                   .long_lists = count,
                                   .long_x = count,
                                   .long_y = 1,
                                   .long_z = 1}});
  buffers.lists.tile_ranges.upload(ranges);
  buffers.lists.long_lists.upload(long_lists);
  buffers.lists.tile_values.upload(values);
}

// Uploads the outputs of the stage project. All splats are IN_MANY_SUPERTILES, for bin_large.comp.
void upload_projection(const FramePlan& plan, const std::vector<Slots>& slots,
                       const std::vector<ViewResult>& results, FrameBuffers& buffers) {
  std::vector<shared::Splat> splats(std::size_t{plan.view_count()} * buffers.slots);
  std::vector<glm::vec4> discs(splats.size());
  std::vector<std::uint32_t> coverages(splats.size()), large;
  std::vector<float> depths(plan.groups.size() * buffers.slots);
  for (std::uint32_t v = 0; v < plan.view_count(); ++v) {
    const std::uint32_t group = plan.views[v].order_group;
    const std::vector<std::uint32_t>& indices = slots[group].indices;
    for (std::size_t slot = 0; slot < indices.size(); ++slot) {
      const std::size_t splat = std::size_t{v} * buffers.slots + slot;
      const reference::Splat& from = results[v].splats[indices[slot]];
      splats[splat] = to_shared(from);
      if (const auto& plane = from.plane)
        discs[splat] = {plane->x, plane->y, 1.0 / glm::dot(*plane, glm::dvec3(from.mean, 1)), from.reach};
      coverages[splat] = results[v].pair_counts[indices[slot]] != 0 ? 1 : 0;  // IN_MANY_SUPERTILES
      if (coverages[splat] == 0) continue;
      large.push_back(static_cast<std::uint32_t>(splat));
      depths[group * buffers.slots + slot] = static_cast<float>(from.order);
    }
  }
  upload_in(plan.settings.precision, splats, buffers.projected.splats);
  if (plan.has_discs()) buffers.projected.discs.upload(discs);
  buffers.projected.coverages.upload(coverages);
  buffers.projected.depths.upload(depths);
  for (std::size_t group = 0; group < slots.size(); ++group) {
    const auto count = static_cast<std::uint32_t>(slots[group].indices.size());
    buffers.drawn[group]->arguments.upload(std::vector{shared::DispatchArguments{.count = count}});
  }
  const auto count = static_cast<std::uint32_t>(large.size());
  const std::uint32_t groups = (count + LARGE_VIEWS - 1) / LARGE_VIEWS;
  buffers.counters.upload(std::vector{shared::Counters{.large_splats = count,
                                                       .large_x = std::min(groups, LARGE_ROW),
                                                       .large_y = (groups + LARGE_ROW - 1) / LARGE_ROW,
                                                       .large_z = 1}});
  buffers.projected.large.upload(large);
}

std::vector<Picture> fill_until(Stage until, const Model& model, const FramePlan& plan,
                                ModelBuffers& model_buffers, FrameBuffers& buffers) {
  std::vector<Picture> pictures;
  if (until == Stage::decode) {
    upload_decoded(model, plan, model_buffers, buffers);
    return pictures;
  }
  if (until == Stage::blend) {
    for (std::uint32_t v = 0; v < plan.view_count(); ++v)
      pictures.push_back(reference::render(model, plan.views[v], reference_settings(plan)));
    return pictures;
  }
  std::vector<ViewResult> results;
  for (std::uint32_t v = 0; v < plan.view_count(); ++v) results.push_back(reference_view(model, plan, v));
  std::vector<Slots> slots;
  for (const OrderGroup& group : plan.groups) slots.push_back(make_slots(plan, group, results));
  upload_projection(plan, slots, results, buffers);
  if (until == Stage::project) return pictures;
  const Supertiles supertiles = entries_of(plan, slots, results, buffers.slots);
  if (until == Stage::bin) upload_entries(supertiles, buffers);
  if (until == Stage::sort) upload_lists(plan, supertiles, buffers);
  return pictures;
}

}  // namespace

render::StandIn reference_until(Stage until) {
  return {until,
          [until](const Model& model, const FramePlan& plan, ModelBuffers& model_buffers,
                  FrameBuffers& buffers) { return fill_until(until, model, plan, model_buffers, buffers); }};
}

}  // namespace binosplat::measure
