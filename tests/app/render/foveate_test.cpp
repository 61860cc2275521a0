// render --foveate and compare --foveate-at: their pictures and reports.

#include <cmath>

#include "app/scene.h"
#include "formats/pictures/exr.h"

namespace binosplat {
namespace {

struct FoveateOption : SceneTest {
  FoveateOption() { add_cameras(); }

  Outcome draw(const std::string& file, const Words& words) const {
    return render(joined(words, {"--size", "216x144", "-o", folder / file}));
  }

  /// Returns what compare prints about the two pictures, for an eye that looks at `gaze`.
  Outcome compared(const std::string& gaze) const {
    return run_program({"compare", folder / "drawn.png", folder / "exact.png", "--foveate-at", gaze, "--json",
                        folder / "c.json"});
  }
};

// Returns the rectangle from `begin` to `end` of an eye's picture, in a picture with both eyes side by side.
Image cut(const Image& whole, int eye, const std::vector<int>& begin, const std::vector<int>& end) {
  Image out(end[0] - begin[0], end[1] - begin[1], whole.channels);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      for (int c = 0; c < whole.channels; ++c)
        out.at(x, y, c) = whole.at(eye * whole.width / 2 + begin[0] + x, begin[1] + y, c);
    }
  }
  return out;
}

TEST_F(FoveateOption, InsetsAreExactInBothEyes) {
  ASSERT_TRUE(good(draw("exact.png", {})));
  const Outcome run =
      checked(draw("drawn.png", {"--foveate", "inset=20deg,context=0.4,gaze=8,-3,4,-3", "--threshold",
                                 "squared", "--tolerance", "0.05", "--json", folder / "run.json"}));
  EXPECT_TRUE(has(run.out, "\ncompose "));
  const Image exact = load_image(folder / "exact.png"), drawn = load_image(folder / "drawn.png");
  EXPECT_NE(exact.data, drawn.data);
  const json view = load_json(folder / "run.json").at("views").at(0);
  EXPECT_EQ(view.at("depth_orders"), 1);
  EXPECT_EQ(view.at("foveated").at(0).at("context"), (json{86, 58}));
  std::vector<std::vector<int>> begins;
  for (int eye = 0; eye < 2; ++eye) {
    const auto part = view.at("foveated").at(static_cast<std::size_t>(eye));
    const auto begin = part.at("inset_begin").get<std::vector<int>>();
    const auto end = part.at("inset_end").get<std::vector<int>>();
    EXPECT_GT(end[0] - begin[0], 60);
    EXPECT_EQ(cut(drawn, eye, begin, end).data, cut(exact, eye, begin, end).data);
    begins.push_back(begin);
  }
  EXPECT_GT(begins[0][0], begins[1][0]);  // the left eye looks further to the right
}

TEST_F(FoveateOption, WorksWithEveryOutput) {
  const std::pair<const char*, Words> outputs[] = {
      {"both.exr", {"--exr", "float"}},
      {"glasses.png", {"--layout", "anaglyph", "--convergence", "4"}},
      {"canted.png", {"--cant", "3", "--order", "distance", "--projection", "tangent"}},
      {"one.png", {"--mono", "--show", "difference"}},
      {"half.png", {"--precision", "half", "--background", "none"}},
  };
  for (const auto& [file, words] : outputs)
    EXPECT_TRUE(good(draw(file, joined(words, {"--foveate", "inset=16"})))) << file;
  EXPECT_EQ(load_image(folder / "both.exr").width, 216);
  if (!have_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  ASSERT_TRUE(good(draw("way.mp4", {"--view", "all", "--foveate", "inset=16"})));
  EXPECT_TRUE(has(facts_of(folder / "way.mp4"), "width=432"));
}

TEST_F(FoveateOption, CompareReportsVisibilityByEccentricity) {
  ASSERT_TRUE(good(draw("exact.png", {"--mono"})));
  ASSERT_TRUE(good(draw("drawn.png", {"--mono", "--foveate", "inset=22,context=0.25"})));
  const std::string fov = fmt::format(",72,{}", 2 * std::atan(108 / 180.0) * 180 / std::acos(-1.0));
  const Outcome run = checked(compared("108" + fov));
  EXPECT_TRUE(has(run.out, "0 to 5 degrees"));
  EXPECT_TRUE(has(run.out, "equal"));
  const auto rings = load_json(folder / "c.json").at("foveated").at("rings");
  ASSERT_GE(rings.size(), 4u);
  EXPECT_TRUE(rings[0].at("psnr_db").is_null());  // the inset
  EXPECT_TRUE(rings[1].at("psnr_db").is_null());
  EXPECT_EQ(rings[0].at("visible"), 0.0);
  EXPECT_LT(rings[3].at("psnr_db").get<double>(), 60.0);  // the context
  // Injected: an eye that looks at the edge.
  ASSERT_TRUE(good(compared("5" + fov)));
  EXPECT_FALSE(load_json(folder / "c.json")["foveated"]["rings"][0]["psnr_db"].is_null());
  EXPECT_TRUE(ended(compared("1000,72,60"), 2, "outside the picture of 216 x 144"));
  EXPECT_TRUE(ended(compared("60"), 2, "three numbers"));
}

}  // namespace
}  // namespace binosplat
