// render --layout: both eyes in one OpenEXR, and messages about their disparities.

#include "app/scene.h"

namespace binosplat {
namespace {

struct LayoutOption : SceneTest {
  LayoutOption() { add_cameras(); }
  json view(std::size_t k = 0) const { return load_json(folder / "r.json")["views"][k]; }
  Outcome draw(const Words& words) const {
    return checked(render(joined(words, {"--json", folder / "r.json"})));
  }
};

TEST_F(LayoutOption, ExrHasBothEyesAsViews) {
  draw({"-o", folder / "pair.exr", "--exr", "float"});
  draw({"--layout", "multi-view", "--background", "none"});
  EXPECT_EQ(folder.files(), (Names{"cameras.json", "model.ply", "pair.exr", "out/front.exr", "r.json"}));
  for (const char* name : {"multiView", "right.R", "right.Z", "right.coverage"})
    EXPECT_TRUE(has(read_text(folder / "pair.exr"), name)) << name;
  draw({"--bits", "16"});
  const auto psnr = [&](const std::string& eye) { return psnr_of_files(folder / "pair.exr", out + eye); };
  EXPECT_GT(psnr("/front_left.png"), 90.0);
  EXPECT_LT(psnr("/front_right.png"), 60.0) << "the right eye as the default view goes unnoticed";
}

TEST_F(LayoutOption, ReportsDisparity) {
  // The model begins 2.5 to 3 units away: 0.6 degrees with eyes 0.03 apart, 4 with eyes 0.2 apart.
  const Outcome plain = draw({"--ipd", "0.03"});
  EXPECT_TRUE(has(plain.out, "disparity"));
  EXPECT_FALSE(has(plain.err, "tire most eyes"));
  json disparity = view()["disparity"];
  EXPECT_GT(disparity["near_px"].get<double>(), 60.0 * 0.03 / 3.0);
  EXPECT_LT(disparity["near_px"].get<double>(), 60.0 * 0.03 / 2.5);
  EXPECT_TRUE(disparity["comfortable"].get<bool>());

  const Outcome wide = draw({"--ipd", "0.2"});
  EXPECT_TRUE(has(wide.err, "tire most eyes"));
  EXPECT_FALSE(view()["disparity"]["comfortable"].get<bool>());
  // The warning's proposal is comfortable.
  const std::size_t at = wide.err.find("--convergence ");
  ASSERT_NE(at, std::string::npos) << wide.err;
  std::istringstream words(wide.err.substr(at, wide.err.find(" avoids them") - at));
  Words options;
  for (std::string word; words >> word;) options.push_back(word);
  if (wide.err.find("--ipd") == std::string::npos) options.insert(options.end(), {"--ipd", "0.2"});
  draw(options);
  disparity = view()["disparity"];
  EXPECT_LE(disparity["near_degrees"].get<double>(), 1.0);
  EXPECT_GE(disparity["far_degrees"].get<double>(), -1.0);
}

TEST_F(LayoutOption, ScreenDistanceFitsFirstView) {
  const std::string png = folder / "pair.png";
  const auto with_eyes = [&](const Words& words) { return draw(joined(words, {"--ipd", "0.1"})); };
  const auto metres = [&](std::size_t k) { return view(k)["convergence_metres"]; };
  const Outcome plain = with_eyes({"-o", png});
  EXPECT_TRUE(has(plain.err, "--convergence METRES for another"));
  EXPECT_FALSE(has(plain.err, "tire most eyes"));
  ASSERT_TRUE(metres(0).is_number());
  const json disparity = view()["disparity"];
  EXPECT_TRUE(disparity["comfortable"].get<bool>()) << disparity;
  EXPECT_NEAR(disparity["focus_metres"].get<double>(), metres(0).get<double>(), 1e-9);
  EXPECT_GT(disparity["near_degrees"].get<double>(), 0.0);
  EXPECT_LT(disparity["far_degrees"].get<double>(), 0.0);
  const Image suited = load_image(png);

  // --convergence with the chosen distance gives the same picture. "inf" means no screen.
  with_eyes({"-o", png, "--convergence", metres(0).dump()});
  EXPECT_EQ(measure::largest_difference(load_image(png), suited).max, 0.0);
  const Outcome infinite = with_eyes({"-o", png, "--convergence", "inf"});
  EXPECT_GT(measure::largest_difference(load_image(png), suited).max, 0.1);
  EXPECT_TRUE(metres(0).is_null());
  EXPECT_TRUE(has(infinite.err, "tire most eyes"));

  // Headsets, canted eyes, single eyes and separate files have no screen.
  for (const Words& other :
       {Words{"-o", out}, Words{"-o", folder / "pair.exr"}, Words{"-o", png, "--cant", "1"},
        Words{"-o", png, "--only", "left"}, Words{"-o", png, "--preset", "headset", "--size", "72x48"}}) {
    const Outcome outcome = with_eyes(other);
    EXPECT_TRUE(metres(0).is_null()) << outcome.err;
    EXPECT_FALSE(has(outcome.err, "for another"));
    // The warning appears only if the user can change the disparity.
    const bool warned = outcome.err.find("tire most eyes") != std::string::npos;
    EXPECT_EQ(warned, other.size() == 2) << outcome.err;
  }

  // All views and all shards of a run have one screen.
  const Words both = {"--layout", "parallel", "--view", "front,side"};
  with_eyes(both);
  const auto of_front = metres(0);
  EXPECT_EQ(metres(1), of_front);
  with_eyes(joined(both, {"--shard", "1/2"}));
  EXPECT_EQ(metres(0), of_front);
  with_eyes({"--layout", "parallel", "--view", "side"});
  EXPECT_NE(metres(0), of_front) << "any view has this one";
}

}  // namespace
}  // namespace binosplat
