// render --show: the debug views in place of the picture.

#include "app/scene.h"
#include "shared/choices.h"

namespace binosplat {
namespace {

struct RenderShow : SceneTest {
  RenderShow() { add_cameras(); }
  const std::string png = folder / "a.png";
};

TEST_F(RenderShow, EveryChoiceDiffersAndReportsRange) {
  std::vector<Image> images;
  for (std::size_t k = 0; k < std::size(show_choices); ++k) {
    const std::string name = show_choices[k].name;
    const Outcome outcome = render({"-o", png, "--threshold", "squared", "--tolerance", "0.5", "--show", name,
                                    "--json", folder / "r.json"});
    ASSERT_TRUE(good(outcome)) << name;
    images.push_back(load_image(png));
    for (std::size_t other = 0; other < k; ++other) {
      if (k == SHOW_PAIRS && other == SHOW_ALPHAS) continue;  // no pixel of this model ends early
      EXPECT_GT(measure::largest_difference(images[other], images[k]).max, 0.1)
          << name << ", " << show_choices[other].name;
    }
    const json view = load_json(folder / "r.json")["views"][0];
    const bool has_range = k >= SHOW_DIFFERENCE;
    EXPECT_EQ(view.contains("show") && view["show"]["max"].get<double>() > 0.0, has_range) << name;
    EXPECT_EQ(bool(has(outcome.out, "max " + name)), has_range) << outcome.out;
    EXPECT_EQ(bool(has(read_text(png), "binosplatShow")), has_range) << name;
  }
}

TEST_F(RenderShow, WorksInLayoutsAndMono) {
  ASSERT_TRUE(good(render({"-o", png, "--show", "visible"})));
  ASSERT_TRUE(good(render({"-o", folder / "l.png", "--show", "visible", "--layout", "over-under"})));
  const Image both = load_image(png), stacked = load_image(folder / "l.png");
  for (int y = 0; y < both.height; ++y) {
    for (int x = 0; x < both.width; ++x) {
      const bool right = 2 * x >= both.width;
      ASSERT_EQ(both.at(x, y, 1), stacked.at(right ? x - both.width / 2 : x, right ? y + both.height : y, 1));
    }
  }
  ASSERT_TRUE(good(render({"-o", png, "--show", "depth", "--mono", "--background", "none"})));
  EXPECT_EQ(load_image(png).channels, 4);
}

}  // namespace
}  // namespace binosplat
