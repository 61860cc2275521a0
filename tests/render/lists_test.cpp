// Lists of pairs that several tiles share: each tile is offered what a list of its own would hold.

#include <algorithm>

#include "base/error.h"
#include "render/faulty_shaders.h"
#include "render/support.h"
#include "support/errors.h"

namespace binosplat {
namespace {

using render::FrameSettings;
using test::same_bits;

// What each tile of a view is offered, slots in the order of blending, tiles row by row.
using Offers = std::vector<std::vector<std::uint32_t>>;

Offers offers(const Model& model, const std::vector<shared::View>& views, std::uint32_t v, int tiles,
              int supertile_side) {
  test::StageRun run(model, views, {.tiles = tiles}, supertile_side);
  run.run_until(render::Stage::ranges);
  const auto counters = run.frame.counters.read<shared::Counters>(1).front();
  EXPECT_EQ(counters.overflow, 0u);
  const std::uint32_t pairs = supertile_side == 1 ? counters.pairs : counters.tile_pairs;
  const auto values = run.frame.lists.values_of_tiles(run.plan).read<std::uint32_t>(pairs);
  const auto ranges =
      run.frame.lists.ranges_of_tiles(run.plan).read<std::uint32_t>(2 * std::size_t{run.plan.tile_count()});
  const shared::View& view = run.plan.views[v];
  const auto side = static_cast<std::uint32_t>(supertile_side);
  const std::uint32_t across = (view.tiles_x + side - 1) / side;
  Offers offered(std::size_t{view.tiles_x} * view.tiles_y);
  for (std::uint32_t y = 0; y < view.tiles_y; ++y) {
    for (std::uint32_t x = 0; x < view.tiles_x; ++x) {
      const std::uint32_t list = view.supertile_offset + y / side * across + x / side;
      const std::uint32_t tile = list * side * side + y % side * side + x % side;
      for (std::uint32_t k = ranges[2 * tile]; k < ranges[2 * tile + 1]; ++k) {
        EXPECT_EQ(values[k] / run.frame.slots, v);
        offered[y * view.tiles_x + x].push_back(values[k] % run.frame.slots);
      }
    }
  }
  return offered;
}

// Two views of ragged sizes that share a depth order.
std::vector<shared::View> two_views() {
  return {make_view(test::front_camera(301, 187, 250)), make_view(test::front_camera(33, 50, 40))};
}

TEST(Lists, OfSeveralTilesOfferEachWhatItsOwnHolds) {
  const Model model = test::random_model(51, 3000, 1);
  for (const int tiles : {TILES_ELLIPSE, TILES_SNUG, TILES_OBB, TILES_AABB}) {
    for (const std::uint32_t v : {0u, 1u}) {
      const Offers own = offers(model, two_views(), v, tiles, 1);
      EXPECT_GT(own.front().size() + own.back().size(), 0u);
      EXPECT_EQ(offers(model, two_views(), v, tiles, 2), own) << tiles_choices[tiles].name << " " << v;
    }
  }
}

// The sequence of frames that these settings draw.
struct DrawnLists {
  std::vector<Picture> pictures;
  std::uint64_t pairs = 0;   // of the last, of tiles
  std::uint64_t listed = 0;  // and of lists
};

DrawnLists draw_frames(const Model& model, const FrameSettings& settings, int supertile_side, int count) {
  render::Frame frame(test::gl_context(), model);
  DrawnLists drawn;
  for (int n = 0; n < count; ++n) {
    const render::FrameReport report = frame.draw(two_views(), settings, {.supertile_side = supertile_side});
    drawn.pairs = report.pairs;
    drawn.listed = report.supertile_pairs;
    for (Picture& picture : frame.read_pictures()) drawn.pictures.push_back(std::move(picture));
  }
  return drawn;
}

bool same_pictures(const DrawnLists& own, const DrawnLists& shared) {
  bool same = true;
  for (std::size_t k = 0; k < own.pictures.size(); ++k)
    same = same && same_bits(own.pictures[k], shared.pictures[k]);
  return same;
}

bool same_frames(const Model& model, const FrameSettings& settings, int count = 1) {
  const DrawnLists own = draw_frames(model, settings, 1, count),
                   shared = draw_frames(model, settings, 2, count);
  EXPECT_EQ(shared.pairs, own.pairs);
  EXPECT_LT(shared.listed, own.listed);
  return same_pictures(own, shared);
}

TEST(Lists, OfSeveralTilesChangeNoPicture) {
  const Model model = test::random_model(52, 4000, 1);
  EXPECT_TRUE(same_frames(model, {}));
  EXPECT_TRUE(same_frames(model, {.tiles = TILES_AABB}));
  EXPECT_TRUE(same_frames(model, {.th = TH_SQUARED, .tolerance = 0.5f}));
  EXPECT_TRUE(same_frames(model, {.th = TH_PERIPHERAL, .tolerance = 5.0f}));
  EXPECT_TRUE(same_frames(model, {.precision = PRECISION_HALF}));
  // Every frame measures what the next goes by.
  EXPECT_TRUE(same_frames(
      model, {.th = TH_SQUARED, .transmittance = TRANSMITTANCE_LAST, .measure_every = 1, .tolerance = 0.5f},
      3));
}

TEST(Lists, OfSplatsOverThousandsOfThemAreWhole) {
  // Of small splats between a few that each make more pairs than a work group does.
  Model model = test::random_model(55, 600, 0);
  for (std::size_t i = 0; i < model.count(); i += 150) model.scale[i] = glm::vec3(4.0f, 5.0f, 3.0f);
  const std::vector<shared::View> views = {make_view(test::front_camera(2048, 1536, 1600)),
                                           make_view(test::front_camera(1600, 1700, 1500))};
  for (const std::uint32_t v : {0u, 1u}) {
    const Offers own = offers(model, views, v, TILES_ELLIPSE, 1);
    std::size_t most = 0;
    for (const std::uint32_t splat : {0u, 1u, 2u}) {
      std::size_t tiles = 0;
      for (const auto& tile : own)
        tiles += static_cast<std::size_t>(std::count(tile.begin(), tile.end(), splat));
      most = std::max(most, tiles);
    }
    EXPECT_GT(most, 4u * SCAN_BLOCK);
    EXPECT_EQ(offers(model, views, v, TILES_ELLIPSE, 2), own) << v;
  }
}

// Whether a fault in a shader changes what a model looks like, drawn by supertiles of so many tiles.
bool is_noticed(const Model& model, const DrawnLists& own, int supertile_side, const char* shader,
                const char* sought, const char* fault) {
  const test::FaultyShaders faulty(shader, sought, fault);
  return !same_pictures(own, draw_frames(model, {}, supertile_side, 1));
}

TEST(Lists, FaultsInWhatIsLeftForPairsAreNoticed) {
  const Model model = test::random_model(52, 4000, 1);
  const DrawnLists own = draw_frames(model, {}, 1, 1);
  const auto fails = [&](const char* shader, const char* sought, const char* fault) {
    return is_noticed(model, own, 2, shader, sought, fault);
  };
  EXPECT_TRUE(fails("pairs.comp", "nth / 2u * across", "nth / 2u"));  // of few lists,
  EXPECT_TRUE(fails("pairs.comp", "to = start_at[place] + in_splat", "to = start_at[place]"));  // of many
  EXPECT_TRUE(fails("tiles/tiles.glsl", "(row_bits & 12u) << 2", "0u"));
  EXPECT_TRUE(fails("pairs_count.comp", "count_of(both.x) + count_of(both.y)", "count_of(both.x)"));
}

// Of the program that draws here, the blocks' lists: with subgroups or without.
TEST(Lists, ABlockThatMissesASplatIsNoticed) {
  const Model model = test::random_model(52, 4000, 1);
  const DrawnLists own = draw_frames(model, {}, 1, 1);
  const auto misses = [&](const char* shader, const char* sought, const char* fault) {
    return is_noticed(model, own, 1, shader, sought, fault);
  };
  if (!test::gl_context().limits().subgroups_of_32 && !test::gl_context().software())
    GTEST_SKIP() << "blend.comp has no blocks";
  if (test::gl_context().limits().subgroups_of_32)
    EXPECT_TRUE(misses("blend_subgroups.comp", "(mine[word] >> bit & 1u) != 0u",
                       "(mine[word] >> bit & 1u) != 0u && word != 1u"));
  else
    EXPECT_TRUE(misses("blend_blocks.comp", "(reached[i + k] >> bit & 1u) == 0u", "k == 3u"));
  EXPECT_TRUE(misses("blocks.glsl", "bits |= ((2u << uint(last))", "bits = ((2u << uint(last))"));
}

TEST(Lists, ATileThatTakesWhatItDoesNotTouchIsNoticed) {
  const test::FaultyShaders faulty("ranges_of_tiles.comp",
                                   "(value >> SUPERTILE_SPLAT_BITS >> nth & 1u) != 0u", "value != 0u");
  // What the square of 3D-GS cuts, and what Th leaves out of a tile, is seen in the tiles beside.
  const Model model = test::random_model(52, 4000, 1);
  for (const FrameSettings& settings :
       {FrameSettings{.tiles = TILES_AABB}, FrameSettings{.th = TH_SQUARED, .tolerance = 0.5f}}) {
    EXPECT_FALSE(same_pictures(draw_frames(model, settings, 1, 1), draw_frames(model, settings, 2, 1)));
  }
}

TEST(Lists, OfSeveralTilesAreShownAlike) {
  const Model model = test::random_model(53, 4000, 1);
  const auto told = [&](int supertile_side) {
    render::Frame frame(test::gl_context(), model);
    frame.draw(two_views(), {.th = TH_SQUARED, .tolerance = 0.5f}, {.supertile_side = supertile_side});
    std::vector<std::vector<float>> all;
    for (int what = SHOW_ALPHAS; what <= SHOW_MEDIAN_DEPTH; ++what)
      for (const Image& image : frame.read_debug_view(what)) all.push_back(image.data);
    return all;
  };
  const auto own = told(1), shared = told(2);
  EXPECT_EQ(own, shared);
  EXPECT_NE(own[0], own[2]) << "the same whatever is shown";
}

TEST(Lists, GrowWithTheirTiles) {
  const Model model = test::random_model(52, 4000, 1);
  render::Frame frame(test::gl_context(), model), ample(test::gl_context(), model);
  const render::FrameReport report = frame.draw(two_views(), {}, {.supertile_side = 2, .pairs = 50});
  EXPECT_GE(report.redrawn, 2);  // for the lists, then for the tiles
  EXPECT_EQ(frame.draw(two_views(), {}, {.supertile_side = 2}).redrawn, 0);
  ample.draw(two_views(), {});
  EXPECT_TRUE(same_bits(frame.read_pictures()[1], ample.read_pictures()[1]));
}

TEST(Lists, OfTilesThatAreLeftToTheFrameChangeNoBit) {
  const Model model = test::random_model(54, 400, 1);
  const auto draw_with = [&](int tile_size, int supertile_side) {
    render::Frame frame(test::gl_context(), model);
    const render::FrameReport report =
        frame.draw(two_views(), {.tile_size = tile_size}, {.supertile_side = supertile_side});
    EXPECT_TRUE(report.supertile_side == 1 || report.supertile_side == 2);
    return frame.read_pictures()[0];
  };
  const Picture expected = draw_with(16, 1);
  EXPECT_TRUE(same_bits(draw_with(16, 0), expected));
  EXPECT_TRUE(same_bits(draw_with(32, 2), expected));
  EXPECT_TRUE(test::fails_saying([&] { draw_with(16, 3); }, {"supertiles of 3 x 3 tiles"}));
}

}  // namespace
}  // namespace binosplat
