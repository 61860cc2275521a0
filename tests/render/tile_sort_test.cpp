// The stage tile_sort against std::stable_sort: pairs by supertile, and within it in depth order, as they
// came.

#include <algorithm>
#include <utility>

#include "render/stages.h"
#include "render/support.h"
#include "stereo/rig.h"

namespace binosplat {
namespace {

using render::Stage;
using SortedPairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;  // supertile, splat

SortedPairs read_pairs(test::StageRun& run) {
  const std::uint32_t count = run.frame.counters.read<shared::Counters>(1).front().pairs;
  const auto lists = run.frame.lists.pairs.keys().read<std::uint32_t>(count);
  const auto splats = run.frame.lists.pairs.values().read<std::uint32_t>(count);
  SortedPairs pairs(count);
  std::transform(lists.begin(), lists.end(), splats.begin(), pairs.begin(),
                 [](std::uint32_t list, std::uint32_t splat) { return std::pair(list, splat); });
  return pairs;
}

SortedPairs sorted(SortedPairs pairs) {
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  return pairs;
}

struct TileSort
    : testing::TestWithParam<std::pair<double, int>> {  // cant in degrees, tiles along a list's side
  TileSort()
      : rig(stereo::make_rig(test::front_camera(640, 400, 600),
                             {.ipd = 0.1, .cant_degrees = GetParam().first})),
        run(model, {rig.views.begin(), rig.views.end()}, {}, GetParam().second) {
    run.run_until(Stage::pairs);
    before = read_pairs(run);
  }

  const Model model = test::random_model(91, 3000, 0);
  const stereo::EyePair rig;
  test::StageRun run;
  SortedPairs before;
};

TEST_P(TileSort, IsAStableSortByList) {
  ASSERT_GT(before.size(), 3000u);
  EXPECT_NE(before, sorted(before));
  run.run_until(Stage::tile_sort);
  EXPECT_EQ(read_pairs(run), sorted(before));
}

TEST_P(TileSort, ShortOfTheHighestDigitItIsNone) {
  render::FramePlan plan = run.plan;
  ASSERT_GT(plan.supertile_bits(), 8u);  // a digit
  plan.supertile_count = 2;              // planted fault: bits for so many lists
  gl::Dispatcher dispatcher(test::gl_context());
  render::tile_sort(dispatcher, plan, run.frame);
  EXPECT_NE(read_pairs(run), sorted(before));
}

INSTANTIATE_TEST_SUITE_P(ParallelAndCanted, TileSort,
                         testing::Values(std::pair(0.0, 1), std::pair(5.0, 1), std::pair(0.0, 2)));

}  // namespace
}  // namespace binosplat
