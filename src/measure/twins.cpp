#include "measure/twins.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/error.h"
#include "primitives/arguments.h"
#include "reference/render.h"
#include "reference/threshold.h"
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

// A cone as shaders/projection/tangent.glsl keeps it.
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

// What decodes the model for view v.
reference::Decoding decoding_for(const FramePlan& plan, std::uint32_t v) {
  const std::uint32_t begin = v - v % plan.views_per_decoding;
  const std::uint32_t end = std::min(begin + plan.views_per_decoding, plan.asked);
  return {{plan.views.begin() + begin, plan.views.begin() + end}, plan.settings.anchor_cull};
}

reference::Settings reference_settings(const FramePlan& plan, std::uint32_t v) {
  const FrameSettings& s = plan.settings;
  return {.tiles = s.tiles,
          .tile_size = s.tile_size,
          .th = s.th,
          .tolerance = plan.tolerance,
          .decoding = decoding_for(plan, v),
          .perspective = plan.perspective};
}

// Into a buffer of Gaussians or splats, in the precision that the shaders expect there.
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

// Gaussians, colours and bits of one decoding of a page, as the stage decode leaves them.
struct DecodedPage {
  std::vector<shared::Gaussian> gaussians;
  std::vector<glm::vec4> harmonics;
  std::vector<std::uint32_t> kept;
};

void add(const reference::Decoded& decoded, std::size_t place, std::size_t offset_count, DecodedPage& page) {
  constexpr double sh_c0 = 0.28209479177387814;
  const reference::Gaussian& g = decoded.gaussian;
  page.gaussians[place] = {glm::vec4(glm::dvec4(g.position, g.opacity)), glm::vec4(g.rotation),
                           glm::vec4(glm::dvec4(g.scale, 0.0))};
  page.harmonics[place] = glm::vec4(glm::dvec4((decoded.colour - 0.5) / sh_c0, 0.0));
  page.kept[place / offset_count] |= 1u << place % offset_count;
}

void upload_decoded(const Model& model, const FramePlan& plan, ModelBuffers& model_buffers,
                    FrameBuffers& buffers) {
  if (!model.scaffold) fail("--reference-until decode: {} is no Scaffold-GS model", model.name);
  std::vector<std::vector<reference::Decoded>> decodings;
  for (std::uint32_t v = 0; v < plan.view_count(); v += plan.views_per_decoding) {
    const reference::Decoding decoding = decoding_for(plan, v);
    decodings.push_back(reference::decode(*model.scaffold, decoding.views, decoding.anchor_cull));
  }
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

// What the reference makes of one view.
struct ViewResult {
  std::vector<reference::Splat> splats;
  reference::TileLists lists;
  std::vector<std::uint32_t> pair_counts;
};

ViewResult reference_view(const Model& model, const FramePlan& plan, std::uint32_t v) {
  const shared::View& view = plan.views[v];
  const FrameSettings& settings = plan.settings;
  ViewResult result;
  result.splats = reference::project_all(model, view, decoding_for(plan, v), plan.perspective);
  reference::set_thresholds(result.splats, settings.th, plan.tolerance);
  const std::vector<std::uint32_t> order = reference::depth_order(result.splats);
  if (settings.tiles == TILES_ALL) {
    // One list for the whole view, as on the GPU.
    result.lists = {1,
                    1,
                    static_cast<std::uint32_t>(settings.tile_size),
                    {0, static_cast<std::uint32_t>(order.size())},
                    order};
  } else {
    result.lists = reference::make_lists(result.splats, order, view, settings.tiles, settings.tile_size);
  }
  result.pair_counts.resize(model.count());
  for (const std::uint32_t i : result.lists.gaussians) ++result.pair_counts[i];
  return result;
}

// What an order group draws, in index order, and where each Gaussian stands in it.
struct Slots {
  std::vector<std::uint32_t> indices;
  std::vector<std::uint32_t> of;  // by Gaussian; only for those in `indices`
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

using Pair = std::pair<std::uint32_t, std::uint32_t>;  // supertile, splat

// In depth order over the views of each group, as the stage pairs leaves them.
std::vector<Pair> pairs_in_depth_order(const FramePlan& plan, const std::vector<Slots>& slots,
                                       const std::vector<ViewResult>& results, std::uint32_t room) {
  std::vector<std::pair<std::uint64_t, Pair>> ranked;  // (group, rank in its depth order), pair
  for (std::uint32_t v = 0; v < plan.view_count(); ++v) {
    const std::uint32_t group = plan.views[v].order_group;
    const std::vector<std::uint32_t> order = reference::depth_order(results[v].splats);
    std::vector<std::uint64_t> rank(plan.gaussian_count);
    for (std::size_t r = 0; r < order.size(); ++r) rank[order[r]] = r;
    const reference::TileLists& lists = results[v].lists;
    const std::uint32_t first = plan.settings.tiles == TILES_ALL ? v : plan.views[v].supertile_offset;
    for (std::uint32_t t = 0; t + 1 < lists.begin.size(); ++t) {
      for (std::uint32_t k = lists.begin[t]; k < lists.begin[t + 1]; ++k) {
        const std::uint32_t i = lists.gaussians[k];
        ranked.push_back({std::uint64_t{group} << 32 | rank[i], {first + t, v * room + slots[group].of[i]}});
      }
    }
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Pair> pairs;
  pairs.reserve(ranked.size());
  for (const auto& entry : ranked) pairs.push_back(entry.second);
  return pairs;
}

void upload_pairs(const std::vector<Pair>& pairs, std::uint32_t supertile_bits, std::uint32_t groups_max,
                  FrameBuffers& buffers) {
  std::vector<std::uint32_t> keys;
  std::vector<std::uint32_t> values;
  for (const auto& [supertile, splat] : pairs) {
    keys.push_back(supertile);
    values.push_back(splat);
  }
  const auto count = static_cast<std::uint32_t>(pairs.size());
  buffers.lists.pairs.reserve(count);
  buffers.sort.reserve(buffers.lists.pairs, supertile_bits);
  buffers.lists.pairs.keys().upload(keys);
  buffers.lists.pairs.values().upload(values);
  buffers.lists.pair_arguments.upload(std::vector{primitives::make_sort_arguments(
      count, primitives::RadixSort::digit_bits(supertile_bits), groups_max, buffers.lists.pairs.block())});
}

void upload_projection(const FramePlan& plan, const std::vector<Slots>& slots,
                       const std::vector<ViewResult>& results, FrameBuffers& buffers) {
  std::vector<shared::Splat> splats(std::size_t{plan.view_count()} * buffers.slots);
  std::vector<std::uint32_t> pair_counts(splats.size());
  for (std::uint32_t v = 0; v < plan.view_count(); ++v) {
    const std::vector<std::uint32_t>& indices = slots[plan.views[v].order_group].indices;
    for (std::size_t slot = 0; slot < indices.size(); ++slot) {
      splats[std::size_t{v} * buffers.slots + slot] = to_shared(results[v].splats[indices[slot]]);
      pair_counts[slot * plan.view_count() + v] = results[v].pair_counts[indices[slot]];
    }
  }
  upload_in(plan.settings.precision, splats, buffers.projected.splats);
  buffers.projected.coverages.upload(pair_counts);
}

// The slots as the stage project leaves them, or `sorted` as the stage order does.
void upload_order(const OrderGroup& group, const Slots& slots, const std::vector<ViewResult>& results,
                  bool sorted, std::uint32_t groups_max, FrameBuffers& buffers) {
  std::vector<std::uint32_t> values(slots.indices.size());
  std::iota(values.begin(), values.end(), 0u);
  // Of the first view that draws it: of Scaffold-GS an eye may lack what the other has.
  const auto depth = [&](std::uint32_t slot) {
    const std::uint32_t i = slots.indices[slot];
    const auto draws = [&](const ViewResult& result) { return result.splats[i].drawn; };
    return std::find_if(results.begin(), results.end(), draws)->splats[i].order;
  };
  if (sorted) {
    std::stable_sort(values.begin(), values.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return depth(a) < depth(b); });
  }
  std::vector<std::uint32_t> keys;
  for (const std::uint32_t slot : values)
    keys.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(depth(slot))) - group.nearest_key);
  buffers.ordering.order.keys().upload(keys);
  buffers.ordering.order.values().upload(values);
  const auto count = static_cast<std::uint32_t>(values.size());
  buffers.drawn.front()->arguments.upload(std::vector{primitives::make_sort_arguments(
      count, primitives::RadixSort::digit_bits(group.key_bits), groups_max, buffers.ordering.order.block())});
}

void upload_ranges(const FramePlan& plan, const std::vector<Pair>& sorted, FrameBuffers& buffers) {
  std::vector<std::uint32_t> ranges(2 * std::size_t{std::max(plan.supertile_count, plan.view_count())});
  for (std::uint32_t k = 0; k < sorted.size(); ++k) {
    const std::uint32_t supertile = sorted[k].first;
    if (k == 0 || sorted[k - 1].first != supertile) ranges[2 * supertile] = k;
    ranges[2 * supertile + 1] = k + 1;
  }
  buffers.lists.ranges.upload(ranges);
}

std::vector<Picture> fill_until(Stage until, const Model& model, const FramePlan& plan,
                                ModelBuffers& model_buffers, FrameBuffers& buffers) {
  const std::uint32_t groups_max = buffers.context().limits().groups;
  std::vector<Picture> pictures;
  if (until == Stage::decode) {
    upload_decoded(model, plan, model_buffers, buffers);
    return pictures;
  }
  if (until == Stage::blend) {
    for (std::uint32_t v = 0; v < plan.view_count(); ++v)
      pictures.push_back(reference::render(model, plan.views[v], reference_settings(plan, v)));
    return pictures;
  }
  if (until < Stage::pairs && plan.groups.size() > 1) {
    fail("--reference-until {}: only for views that share one depth order (no --cant)", name_of(until));
  }
  std::vector<ViewResult> results;
  for (std::uint32_t v = 0; v < plan.view_count(); ++v) results.push_back(reference_view(model, plan, v));
  std::vector<Slots> slots;
  for (const OrderGroup& group : plan.groups) slots.push_back(make_slots(plan, group, results));
  upload_projection(plan, slots, results, buffers);
  if (until < Stage::pairs) {
    upload_order(plan.groups.front(), slots.front(), results, until == Stage::order, groups_max, buffers);
    return pictures;
  }
  std::vector<Pair> pairs = pairs_in_depth_order(plan, slots, results, buffers.slots);
  if (until >= Stage::tile_sort) {
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const Pair& a, const Pair& b) { return a.first < b.first; });
  }
  upload_pairs(pairs, plan.supertile_bits(), groups_max, buffers);
  if (until == Stage::ranges) upload_ranges(plan, pairs, buffers);
  buffers.counters.upload(std::vector{shared::Counters{.pairs = static_cast<std::uint32_t>(pairs.size())}});
  return pictures;
}

}  // namespace

render::StandIn reference_until(Stage until) {
  return {until,
          [until](const Model& model, const FramePlan& plan, ModelBuffers& model_buffers,
                  FrameBuffers& buffers) { return fill_until(until, model, plan, model_buffers, buffers); }};
}

}  // namespace binosplat::measure
