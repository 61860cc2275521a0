// The stages order, pairs, tile_sort and ranges: which splats each tile blends, and in which order.

#include <algorithm>
#include <bit>
#include <set>

#include "render/support.h"

namespace binosplat {
namespace {

// Each tile's list in the order of blending, for all tiles of all views: view * Gaussians of the model +
// Gaussian.
using Lists = std::vector<std::vector<std::uint32_t>>;

Lists gpu_lists(test::StageRun& run) {
  run.run_until(render::Stage::ranges);
  const auto counters = run.frame.counters.read<shared::Counters>(1).front();
  EXPECT_EQ(counters.overflow, 0u);
  const auto values = run.frame.lists.pairs.values().read<std::uint32_t>(counters.pairs);
  const auto ranges = run.frame.lists.ranges.read<std::uint32_t>(2 * std::size_t{run.plan.supertile_count});
  Lists lists(run.plan.supertile_count);
  std::size_t total = 0;
  for (std::uint32_t t = 0; t < run.plan.supertile_count; ++t) {
    for (std::uint32_t k = ranges[2 * t]; k < ranges[2 * t + 1]; ++k) {
      const std::uint32_t view = values[k] / run.frame.slots;
      const std::uint32_t gaussian =
          run.indices[run.plan.views[view].order_group][values[k] % run.frame.slots];
      lists[t].push_back(view * run.plan.gaussian_count + gaussian);
    }
    total += lists[t].size();
  }
  EXPECT_EQ(total, counters.pairs);
  return lists;
}

Lists reference_lists(const Model& model, const render::FramePlan& plan) {
  Lists lists;
  for (std::uint32_t v = 0; v < plan.view_count(); ++v) {
    const auto splats = reference::project_all(model, plan.views[v]);
    const auto tiles = reference::make_lists(splats, reference::depth_order(splats), plan.views[v],
                                             plan.settings.tiles, plan.settings.tile_size);
    for (std::uint32_t t = 0; t + 1 < tiles.begin.size(); ++t) {
      auto& list = lists.emplace_back(tiles.gaussians.begin() + tiles.begin[t],
                                      tiles.gaussians.begin() + tiles.begin[t + 1]);
      for (std::uint32_t& i : list) i += v * plan.gaussian_count;
    }
  }
  return lists;
}

// Pairs that only one of the two has.
std::size_t differing_entries(const Lists& a, const Lists& b) {
  std::size_t count = 0;
  for (std::size_t t = 0; t < a.size(); ++t) {
    const std::set<std::uint32_t> in_a(a[t].begin(), a[t].end());
    const std::set<std::uint32_t> in_b(b[t].begin(), b[t].end());
    std::vector<std::uint32_t> only;
    std::set_symmetric_difference(in_a.begin(), in_a.end(), in_b.begin(), in_b.end(),
                                  std::back_inserter(only));
    count += only.size();
  }
  return count;
}

std::size_t total(const Lists& lists) {
  std::size_t count = 0;
  for (const auto& list : lists) count += list.size();
  return count;
}

class Pairs : public testing::TestWithParam<std::tuple<int, int>> {};  // tiles, tile size

TEST_P(Pairs, EqualTheReferences) {
  const auto [tiles, tile_size] = GetParam();
  const render::FrameSettings settings = {.tiles = tiles, .tile_size = tile_size};
  const Model model = test::random_model(21, 2000, 0);
  const std::vector views = {make_view(test::front_camera(333, 131, 300)),
                             make_view(test::front_camera(131, 222, 200))};
  test::StageRun run(model, views, settings);
  const Lists lists = gpu_lists(run);
  const Lists expected = reference_lists(model, run.plan);
  ASSERT_EQ(lists.size(), expected.size());
  EXPECT_GT(total(expected), 5000u);
  // fp32 may decide otherwise only at a boundary: 0.02 % (docs/method.md 8).
  EXPECT_LE(differing_entries(lists, expected), total(expected) / 5000 + 1);

  Lists shifted = expected;  // every list one tile further: what an index off by one would do
  std::rotate(shifted.begin(), shifted.begin() + 1, shifted.end());
  EXPECT_GT(differing_entries(lists, shifted), total(expected) / 100);
}

TEST_P(Pairs, AreInDepthOrderWithTiesByIndex) {
  const auto [tiles, tile_size] = GetParam();
  Model model = test::random_model(22, 1500, 0);
  for (std::size_t i = 0; i < 300; ++i) model.position[5 * i].z = 2.0f;  // 300 at equal depth
  test::StageRun run(model, {make_view(test::front_camera(160, 96, 150))},
                     {.tiles = tiles, .tile_size = tile_size});
  const Lists lists = gpu_lists(run);
  const auto splats = run.projected(0).splats;
  const auto key = [&](std::uint32_t i) { return std::pair(splats[i].depth, i); };
  std::size_t ties = 0;
  for (const auto& list : lists) {
    for (std::size_t k = 1; k < list.size(); ++k) {
      EXPECT_LT(key(list[k - 1]), key(list[k]));
      ties += splats[list[k - 1]].depth == splats[list[k]].depth ? 1 : 0;
    }
  }
  EXPECT_GT(ties, 100u);
}

INSTANTIATE_TEST_SUITE_P(TilesAndSizes, Pairs,
                         testing::Combine(testing::Values(TILES_AABB, TILES_ELLIPSE),
                                          testing::Values(8, 16, 32)));

TEST(PairsOf, OneSplatOverEveryTileHasEveryTile) {
  Model model;
  test::add(model, {0, 0, 2}, glm::vec3(100.0f), 0.5f);
  test::StageRun run(model, {make_view(test::front_camera(1000, 700, 500))}, {.tile_size = 8});
  const Lists lists = gpu_lists(run);
  EXPECT_TRUE(std::all_of(lists.begin(), lists.end(), [](const auto& list) { return list.size() == 1; }));
}

TEST(PairsOf, SplatsOnTileEdgesAndBeyondThePictureEqualTheReferences) {
  Model model;
  // Means every quarter pixel across a tile's corner, and rows of them outside each side, with sizes from a
  // point up.
  for (int i = -8; i <= 8; ++i) {
    for (const float size : {0.0f, 0.002f, 0.01f, 0.1f}) {
      const float at = 0.25f * static_cast<float>(i) / 64.0f;
      test::add(model, {at, at, 1}, glm::vec3(size), 0.9f);
      test::add(model, {-0.5f - at, 0.1f * at, 1}, glm::vec3(size), 0.9f);
      test::add(model, {0.1f, 0.52f + at, 1}, glm::vec3(size, size, 0.0f), 0.9f, glm::vec3(1),
                {1, 0, 0, 0.4f});
      test::add(model, {0.8f + at, -0.9f, 1}, glm::vec3(size * 4, size, size), 0.99f, glm::vec3(1),
                {1, 0, 0, -0.4f});
    }
  }
  const std::vector views = {make_view(test::front_camera(64, 64, 64))};
  for (const int tile_size : {8, 16, 32}) {
    test::StageRun run(model, views, {.tile_size = tile_size});
    const Lists lists = gpu_lists(run);
    EXPECT_LE(differing_entries(lists, reference_lists(model, run.plan)), 1u) << tile_size;
    EXPECT_GT(total(lists), 100u);
  }
}

}  // namespace
}  // namespace binosplat
