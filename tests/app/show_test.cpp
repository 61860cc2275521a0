// render --show: what is shown in place of the picture.

#include "app/scene.h"
#include "formats/image_file.h"
#include "measure/metrics.h"

namespace binosplat {
namespace {

using test::good;
using test::Outcome;
using test::read_text;
using test::Words;

struct RenderShow : test::SceneTest {
  RenderShow() { add_cameras(); }
  const std::string png = folder / "a.png";
};

TEST_F(RenderShow, EveryChoiceIsAnotherPictureAndSaysItsRange) {
  const Words names = {"picture", "split",   "difference", "disagreement", "depth",
                       "alphas",  "visible", "pairs",      "light"};
  std::vector<Image> images;
  for (const std::string& name : names) {
    const Outcome outcome =
        render({"-o", png, "--tolerance", "0.5", "--show", name, "--json", folder / "r.json"});
    ASSERT_TRUE(good(outcome)) << name;
    images.push_back(load_image(png));
    for (std::size_t k = 0; k + 1 < images.size(); ++k) {
      if (name == "pairs" && names[k] == "alphas") continue;  // no pixel of this model ends early
      EXPECT_GT(measure::largest_difference(images[k], images.back()).max, 0.1) << name << ", " << names[k];
    }
    const auto view = test::load_json(folder / "r.json")["views"][0];
    const bool has_range = name != "picture" && name != "split";
    EXPECT_EQ(view.contains("show") && view["show"]["most"].get<double>() > 0.0, has_range) << name;
    EXPECT_EQ(outcome.out.find("most " + name) != std::string::npos, has_range) << outcome.out;
    EXPECT_EQ(read_text(png).find("binosplatShow") != std::string::npos, has_range) << name;
  }
}

TEST_F(RenderShow, InLayoutsAndOfOneEye) {
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
