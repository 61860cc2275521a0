// The size of tiles where it is left to the frame.

#include "render/tile_choice.h"

#include "render/support.h"

namespace binosplat::render {
namespace {

constexpr FrameSettings automatic = {.tile_size = TILE_SIZE_AUTO};

int next(const TileChoice& choice, const FrameSettings& settings = automatic, bool has_subgroups = true) {
  return choice.resolve(settings, has_subgroups).tile_size;
}

TEST(TileChoice, GoesByThePairsOfASplat) {
  TileChoice choice;
  EXPECT_EQ(next(choice), 16);
  choice.drew(16, 590, 100);
  EXPECT_EQ(next(choice), 16);
  choice.drew(16, 610, 100);
  EXPECT_EQ(next(choice), 32);
  choice.drew(32, 260, 100);
  EXPECT_EQ(next(choice), 32);
  choice.drew(32, 240, 100);
  EXPECT_EQ(next(choice), 16);
  choice.drew(16, 0, 0);
  EXPECT_EQ(next(choice), 16);
}

TEST(TileChoice, IsForExactFramesBlendedBySubgroups) {
  TileChoice choice;
  choice.drew(16, 1000, 100);
  EXPECT_EQ(next(choice, {.th = TH_SQUARED, .tile_size = TILE_SIZE_AUTO}), 16);
  EXPECT_EQ(next(choice, {.transmittance = TRANSMITTANCE_LAST, .tile_size = TILE_SIZE_AUTO}), 16);
  EXPECT_EQ(next(choice, {.weigh = true, .tile_size = TILE_SIZE_AUTO}), 16);
  EXPECT_EQ(next(choice, automatic, false), 16);
  EXPECT_EQ(next(choice, {.tile_size = 8}), 8);
}

TEST(TileChoice, ChangesNoBit) {
  const Model model = test::random_model(81, 400, 1);
  const shared::View view = make_view(test::front_camera(150, 110, 150));
  Frame frame(test::gl_context(), model);
  frame.draw(std::span(&view, 1), {.tile_size = 16});
  const Picture expected = frame.read_pictures()[0];
  for (int n = 0; n < 3; ++n) {
    const FrameReport report = frame.draw(std::span(&view, 1), automatic);
    EXPECT_TRUE(report.tile_size == 16 || report.tile_size == 32);
    EXPECT_TRUE(test::same_bits(frame.read_pictures()[0], expected)) << "frame " << n;
  }
  frame.draw(std::span(&view, 1), {.tile_size = 32});
  EXPECT_TRUE(test::same_bits(frame.read_pictures()[0], expected));
}

}  // namespace
}  // namespace binosplat::render
