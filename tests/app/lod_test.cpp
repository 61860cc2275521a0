// binosplat render --gpu-memory: levels of detail that fit.

#include "app/scene.h"
#include "support/fixtures.h"

namespace binosplat {
namespace {

using test::ended;
using test::good;
using test::Outcome;

TEST(RenderLevels, FitTheMemoryNearTheCameraFirst) {
  REQUIRE_FIXTURES(fixtures);
  const test::TempFolder folder;
  const auto render = [&](const std::string& eye, const std::string& memory) {
    return test::run_program({"render", fixtures / "sog/st-lod", "--eye", eye, "--at", "0,0,5", "--size",
                              "64x64", "--gpu-memory", memory, "-o", folder / "out"});
  };
  // Both eyes' frame takes 1.2 MB, and a thousand Gaussians 0.3.
  const Outcome all = render("0,0,-20", "20");
  ASSERT_TRUE(good(all));
  EXPECT_NE(all.err.find("1000 Gaussians of level 0\n"), std::string::npos) << all.err;
  const Outcome right = render("12,0,13", "1.4");
  ASSERT_TRUE(good(right));
  EXPECT_NE(right.err.find("248 Gaussians of level 0, 185 Gaussians of level 1"), std::string::npos)
      << right.err;
  const Outcome left = render("-14,-1,0", "1.46");
  ASSERT_TRUE(good(left));
  EXPECT_NE(left.err.find("505 Gaussians of level 0, 130 Gaussians of level 1"), std::string::npos)
      << left.err;
  const Outcome none = render("0,0,-20", "0.5");
  ASSERT_TRUE(good(none));
  EXPECT_NE(none.err.find("even its coarsest levels of detail have 250 Gaussians"), std::string::npos)
      << none.err;
  const Outcome framed = test::run_program({"render", fixtures / "sog/st-lod", "--orbit", "1", "--size",
                                            "64x64", "--gpu-memory", "20", "-o", folder / "out"});
  ASSERT_TRUE(good(framed));
  EXPECT_NE(framed.err.find("1000 Gaussians of level 0\n"), std::string::npos) << framed.err;
}

using LevelErrors = test::SceneTest;

TEST_F(LevelErrors, SayWhatToDo) {
  EXPECT_TRUE(ended(render({"--gpu-memory", "100", "-o", out}), 2, "no levels of detail to choose from"));
  EXPECT_TRUE(ended(render({"--gpu-memory", "100", "--lod", "1", "-o", out}), 2, "leave one of them out"));
  EXPECT_TRUE(ended(render({"--gpu-memory", "0", "-o", out}), 2, "--gpu-memory"));
  EXPECT_TRUE(ended(test::run_program({"render", "demo:room", "--gpu-memory", "100", "-o", out}), 2,
                    "--gpu-memory is for model files"));
  EXPECT_EQ(folder.files(), std::set<std::string>{"model.ply"});
}

}  // namespace
}  // namespace binosplat
