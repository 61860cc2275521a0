// The stage ranges against std::equal_range: where each list lies among the sorted pairs.

#include <algorithm>

#include "render/faulty_shaders.h"
#include "render/support.h"

namespace binosplat {
namespace {

using Ranges = std::vector<std::uint32_t>;  // begin and end of each list

Ranges on_gpu(test::StageRun& run) {
  run.run_until(render::Stage::ranges);
  return run.frame.lists.ranges.read<std::uint32_t>(2 * std::size_t{run.plan.supertile_count});
}

// Of the keys as the GPU has sorted them; 0 to 0 for a list without pairs.
Ranges expected(test::StageRun& run) {
  const std::uint32_t count = run.frame.counters.read<shared::Counters>(1).front().pairs;
  const auto keys = run.frame.lists.pairs.keys().read<std::uint32_t>(count);
  Ranges ranges;
  for (std::uint32_t list = 0; list < run.plan.supertile_count; ++list) {
    const auto [begin, end] = std::equal_range(keys.begin(), keys.end(), list);
    ranges.push_back(begin == end ? 0 : static_cast<std::uint32_t>(begin - keys.begin()));
    ranges.push_back(begin == end ? 0 : static_cast<std::uint32_t>(end - keys.begin()));
  }
  return ranges;
}

struct RangesStage : testing::Test {
  const Model model = test::random_model(92, 300, 0);  // some tiles stay empty
  const std::vector<shared::View> views = {make_view(test::front_camera(200, 130, 90)),
                                           make_view(test::front_camera(61, 47, 30))};
};

TEST_F(RangesStage, AreThoseOfTheSortedPairs) {
  test::StageRun run(model, views);
  const Ranges ranges = on_gpu(run);
  EXPECT_EQ(ranges, expected(run));
  std::size_t empty = 0;
  for (std::size_t list = 0; list < ranges.size(); list += 2) empty += ranges[list] == ranges[list + 1];
  EXPECT_GT(empty, 0u);
  EXPECT_LT(empty, ranges.size() / 4);
}

TEST_F(RangesStage, AnEndThatIsOneShortIsCaught) {
  const test::FaultyShaders faulty("ranges.comp", "!= tile) ranges[2u * tile + 1u] = at + 1u",
                                   "!= tile) ranges[2u * tile + 1u] = at");
  test::StageRun run(model, views);
  const Ranges ranges = on_gpu(run);
  EXPECT_NE(ranges, expected(run));
}

}  // namespace
}  // namespace binosplat
