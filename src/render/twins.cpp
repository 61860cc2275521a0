#include "render/twins.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "base/error.h"
#include "primitives/amount.h"
#include "reference/render.h"

namespace binosplat::render {

namespace {

shared::Splat to_shared(const reference::Splat& s) {
  shared::Splat out{};
  out.mean = glm::vec2(s.mean);
  out.depth = static_cast<float>(s.depth);
  out.opacity = static_cast<float>(s.opacity);
  out.conic = glm::vec4(glm::dvec4(s.conic, std::sqrt(s.det)));
  out.colour = glm::vec4(glm::dvec4(s.colour, 0.0));
  return out;
}

// What the reference makes of one view.
struct ViewResult {
  std::vector<reference::Splat> splats;
  reference::TileLists lists;
  std::vector<std::uint32_t> tile_counts;
};

ViewResult reference_view(const Model& model, const shared::View& view, const FrameSettings& settings) {
  ViewResult result;
  result.splats = reference::project_all(model, view);
  const std::vector<std::uint32_t> order = reference::depth_order(result.splats);
  if (settings.tiles == TILES_ALL) {
    // One list for the whole view, as on the GPU.
    result.lists = {1, 1, static_cast<std::uint32_t>(settings.tile_size), {0, static_cast<std::uint32_t>(order.size())}, order};
  } else {
    result.lists = reference::make_lists(result.splats, order, view, settings.tiles, settings.tile_size);
  }
  result.tile_counts.resize(model.count());
  for (const std::uint32_t i : result.lists.gaussians) ++result.tile_counts[i];
  return result;
}

using Pair = std::pair<std::uint32_t, std::uint32_t>;  // list, splat

// In depth order over the views of each group, as the stage pairs leaves them.
std::vector<Pair> pairs_in_depth_order(const FrameShape& shape, const std::vector<ViewResult>& results) {
  std::vector<std::pair<std::uint64_t, Pair>> ranked;  // (group, rank in its depth order), pair
  for (std::uint32_t v = 0; v < shape.view_count(); ++v) {
    const std::vector<std::uint32_t> order = reference::depth_order(results[v].splats);
    std::vector<std::uint64_t> rank(shape.gaussian_count);
    for (std::size_t r = 0; r < order.size(); ++r) rank[order[r]] = r;
    const reference::TileLists& lists = results[v].lists;
    const std::uint32_t first = shape.settings.tiles == TILES_ALL ? v : shape.views[v].tile_offset;
    for (std::uint32_t t = 0; t + 1 < lists.begin.size(); ++t) {
      for (std::uint32_t k = lists.begin[t]; k < lists.begin[t + 1]; ++k) {
        const std::uint32_t i = lists.gaussians[k];
        ranked.push_back({std::uint64_t{shape.views[v].order_group} << 32 | rank[i],
                          {first + t, v * shape.gaussian_count + i}});
      }
    }
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Pair> pairs;
  pairs.reserve(ranked.size());
  for (const auto& entry : ranked) pairs.push_back(entry.second);
  return pairs;
}

void upload_pairs(const std::vector<Pair>& pairs, std::uint32_t groups_max, FrameBuffers& buffers) {
  std::vector<std::uint32_t> keys;
  std::vector<std::uint32_t> values;
  for (const auto& [list, splat] : pairs) {
    keys.push_back(list);
    values.push_back(splat);
  }
  const auto count = static_cast<std::uint32_t>(pairs.size());
  buffers.pairs.reserve(count);
  buffers.sort.reserve(count);
  buffers.pairs.keys().upload(keys);
  buffers.pairs.values().upload(values);
  buffers.pair_amounts.upload(std::vector{primitives::make_sort_amounts(count, groups_max)});
}

void upload_projection(const FrameShape& shape, const std::vector<ViewResult>& results, FrameBuffers& buffers) {
  std::vector<shared::Splat> splats;
  std::vector<std::uint32_t> tile_counts;
  std::vector<std::uint32_t> depth_keys(shape.groups.size() * shape.gaussian_count, DEPTH_KEY_NONE);
  for (std::uint32_t v = 0; v < shape.view_count(); ++v) {
    for (std::uint32_t i = 0; i < shape.gaussian_count; ++i) {
      splats.push_back(to_shared(results[v].splats[i]));
      if (results[v].tile_counts[i] > 0) {
        depth_keys[shape.views[v].order_group * shape.gaussian_count + i] = std::bit_cast<std::uint32_t>(splats.back().depth);
      }
    }
    tile_counts.insert(tile_counts.end(), results[v].tile_counts.begin(), results[v].tile_counts.end());
  }
  buffers.splats.upload(splats);
  buffers.tile_counts.upload(tile_counts);
  buffers.depth_keys.upload(depth_keys);
}

void upload_order(const FrameShape& shape, const std::vector<ViewResult>& results, std::uint32_t groups_max,
                  FrameBuffers& buffers) {
  std::vector<std::uint32_t> order;
  for (const std::uint32_t i : reference::depth_order(results.front().splats)) {
    const bool seen = std::any_of(results.begin(), results.end(), [&](const ViewResult& r) { return r.tile_counts[i] > 0; });
    if (seen) order.push_back(i);
  }
  buffers.order.values().upload(order);
  const auto count = static_cast<std::uint32_t>(order.size());
  buffers.order_amounts.upload(std::vector{primitives::make_sort_amounts(count, groups_max)});
  (void)shape;
}

void upload_ranges(const FrameShape& shape, const std::vector<Pair>& sorted, FrameBuffers& buffers) {
  std::vector<std::uint32_t> ranges(2 * std::size_t{std::max(shape.tile_count, shape.view_count())});
  for (std::uint32_t k = 0; k < sorted.size(); ++k) {
    const std::uint32_t list = sorted[k].first;
    if (k == 0 || sorted[k - 1].first != list) ranges[2 * list] = k;
    ranges[2 * list + 1] = k + 1;
  }
  buffers.ranges.upload(ranges);
}

}  // namespace

std::vector<Picture> fill_from_reference(const Model& model, const FrameShape& shape, std::uint32_t groups_max,
                                         FrameBuffers& buffers) {
  const Stage until = *shape.settings.reference_until;
  std::vector<Picture> pictures;
  if (until == Stage::blend) {
    for (const shared::View& view : shape.views) {
      pictures.push_back(reference::render(model, view, {shape.settings.tiles, shape.settings.tile_size}));
    }
    return pictures;
  }
  std::vector<ViewResult> results;
  for (const shared::View& view : shape.views) results.push_back(reference_view(model, view, shape.settings));
  upload_projection(shape, results, buffers);
  if (until == Stage::order) {
    if (shape.groups.size() > 1) fail("--reference-until order: only for views that share one depth order (no --cant)");
    upload_order(shape, results, groups_max, buffers);
  }
  if (until >= Stage::pairs) {
    std::vector<Pair> pairs = pairs_in_depth_order(shape, results);
    if (until >= Stage::tile_sort) {
      std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.first < b.first; });
    }
    upload_pairs(pairs, groups_max, buffers);
    if (until == Stage::ranges) upload_ranges(shape, pairs, buffers);
    buffers.counters.upload(std::vector{shared::Counters{0, 0, static_cast<std::uint32_t>(pairs.size())}});
  }
  return pictures;
}

}  // namespace binosplat::render
