// render --foveate and compare --foveate-at: what is written, what is said of it, and what is refused.

#include <cmath>

#include "app/scene.h"
#include "formats/exr.h"
#include "formats/image_file.h"

namespace binosplat {
namespace {

using test::ended;
using test::good;

struct Foveate : test::SceneTest {
  Foveate() { add_cameras(); }

  test::Outcome draw(const std::string& file, std::vector<std::string> more) const {
    more.insert(more.end(), {"--size", "216x144", "-o", folder / file});
    return render(std::move(more));
  }

  nlohmann::json json(const char* name) const {
    return nlohmann::json::parse(test::read_text(folder / name));
  }
};

// The part of an eye's picture from (begin) to (end), in a picture whose eyes lie side by side.
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

TEST_F(Foveate, WritesBothEyesWithTheirInsetsExact) {
  ASSERT_TRUE(good(draw("exact.png", {})));
  const auto run = draw("drawn.png", {"--foveate", "inset=20deg,context=0.4,gaze=8,-3,4,-3", "--tolerance",
                                      "0.05", "--json", folder / "run.json"});
  ASSERT_TRUE(good(run));
  EXPECT_NE(run.out.find("left: inset of "), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("context of 86 x 58 px"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("\ncompose "), std::string::npos) << run.out;
  const Image exact = load_image(folder / "exact.png"), drawn = load_image(folder / "drawn.png");
  EXPECT_NE(exact.data, drawn.data);
  const auto view = json("run.json").at("views").at(0);
  EXPECT_EQ(view.at("depth_orders"), 1);
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

TEST_F(Foveate, GoesIntoEveryOutput) {
  const std::vector<std::string> foveate = {"--foveate", "inset=16"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), foveate.begin(), foveate.end());
    return more;
  };
  ASSERT_TRUE(good(draw("both.exr", with({"--exr", "float"}))));
  EXPECT_EQ(load_image(folder / "both.exr").width, 216);
  ASSERT_TRUE(good(draw("glasses.png", with({"--layout", "anaglyph", "--convergence", "4"}))));
  ASSERT_TRUE(
      good(draw("canted.png", with({"--cant", "3", "--order", "distance", "--projection", "tangent"}))));
  ASSERT_TRUE(good(draw("one.png", with({"--mono", "--show", "difference"}))));
  ASSERT_TRUE(good(draw("half.png", with({"--precision", "half", "--tile", "8", "--background", "none"}))));
  if (!have_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  ASSERT_TRUE(good(draw("way.mp4", with({"--view", "all"}))));
  EXPECT_NE(facts_of(folder / "way.mp4").find("width=432"), std::string::npos);
}

TEST_F(Foveate, WhatCannotBeUnderstoodIsNamed) {
  const auto said = [&](const std::string& text, const std::string& expected) {
    return ended(draw("a.png", {"--foveate", text}), 2, expected);
  };
  EXPECT_TRUE(said("inset=0", "--foveate inset 0: expected 1 to 120"));
  EXPECT_TRUE(said("inset=20px", "inset=20px: expected degrees"));
  EXPECT_TRUE(said("inset=nan", "inset nan"));
  EXPECT_TRUE(said("context=2", "context 2: expected 0.05 to 1"));
  EXPECT_TRUE(said("contxt=0.4", "there is no contxt; did you mean context?"));
  EXPECT_TRUE(said("20", "'20' is no WORD=NUMBER"));
  EXPECT_TRUE(said("inset=20,inset=30", "inset is given twice"));
  EXPECT_TRUE(said("gaze=3", "gaze=3: expected degrees to the right and up"));
  EXPECT_TRUE(said("gaze=3,up", "gaze=up: expected degrees"));
  EXPECT_TRUE(said("gaze=60,0", "gaze 60,0: the inset lies outside the picture of 216 x 144"));
  EXPECT_TRUE(said("inset=20,0.4", "'0.4' is no WORD=NUMBER"));
}

TEST_F(Foveate, WhatMakesNoSenseTogetherIsRefused) {
  const auto said = [&](std::vector<std::string> more, const std::string& expected) {
    more.insert(more.end(), {"--foveate", "inset=20", "-o", out});
    return ended(render(std::move(more)), 2, expected);
  };
  EXPECT_TRUE(said({"--vr180"}, "leave --foveate out"));
  EXPECT_TRUE(said({"--quality", "40"}, "--foveate with --quality"));
  EXPECT_TRUE(said({"--reference-until", "blend"}, "the reference draws whole pictures"));
  EXPECT_TRUE(said({"--show", "alphas"}, "--foveate with --show alphas"));
  EXPECT_TRUE(said({"--exr-depth", "median", "--exr", "half"}, "--exr-depth median"));
  EXPECT_TRUE(ended(render({"--mono", "--foveate", "gaze=1,1,2,2", "-o", out}), 2, "two are for both eyes"));
}

TEST_F(Foveate, CompareTellsWhatIsSeenAndWhere) {
  ASSERT_TRUE(good(draw("exact.png", {"--mono"})));
  ASSERT_TRUE(good(draw("drawn.png", {"--mono", "--foveate", "inset=22,context=0.25"})));
  const double fov = 2 * std::atan(108 / 180.0) * 180 / std::acos(-1.0);
  const auto run = test::run_program({"compare", folder / "drawn.png", folder / "exact.png", "--foveate-at",
                                      "108,72," + std::to_string(fov), "--json", folder / "c.json"});
  ASSERT_TRUE(good(run));
  EXPECT_NE(run.out.find("0 to 5 degrees"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("infinite"), std::string::npos) << run.out;
  const auto rings = json("c.json").at("foveated").at("rings");
  ASSERT_GE(rings.size(), 4u);
  EXPECT_TRUE(rings[0].at("psnr_db").is_null());  // the inset
  EXPECT_TRUE(rings[1].at("psnr_db").is_null());
  EXPECT_EQ(rings[0].at("visible"), 0.0);
  EXPECT_LT(rings[3].at("psnr_db").get<double>(), 60.0);  // the context
  // Planted: an eye that looks at the edge.
  const auto beside =
      test::run_program({"compare", folder / "drawn.png", folder / "exact.png", "--foveate-at",
                         "5,72," + std::to_string(fov), "--json", folder / "d.json"});
  ASSERT_TRUE(good(beside));
  EXPECT_FALSE(json("d.json").at("foveated").at("rings")[0].at("psnr_db").is_null());
  EXPECT_TRUE(ended(test::run_program({"compare", folder / "drawn.png", folder / "exact.png", "--foveate-at",
                                       "1000,72,60"}),
                    2, "outside the picture of 216 x 144"));
  EXPECT_TRUE(
      ended(test::run_program({"compare", folder / "drawn.png", folder / "exact.png", "--foveate-at", "60"}),
            2, "three numbers"));
}

}  // namespace
}  // namespace binosplat
