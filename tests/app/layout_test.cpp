// render --layout: both eyes as one file, and what is said of their disparities.

#include "app/scene.h"
#include "formats/image_file.h"
#include "measure/metrics.h"

namespace binosplat {
namespace {

using test::ended;
using test::good;
using test::Outcome;
using test::read_text;
using Names = std::set<std::string>;

struct Layout : test::SceneTest {
  Layout() { add_cameras(); }
  nlohmann::json disparity() const {
    return nlohmann::json::parse(read_text(folder / "r.json"))["views"][0]["disparity"];
  }
};

TEST_F(Layout, AFolderGetsOnePictureAShot) {
  ASSERT_TRUE(
      good(render({"-o", out, "--view", "front", "side", "--layout", "over-under", "--convergence", "3"})));
  EXPECT_EQ(folder.files(), (Names{"cameras.json", "model.ply", "out/front.png", "out/side.png"}));
  ASSERT_TRUE(good(render({"-o", folder / "eyes", "--convergence", "3"})));
  const Image both = load_image(out + "/front.png");
  const Image left = load_image(folder / "eyes/front_left.png");
  const Image right = load_image(folder / "eyes/front_right.png");
  ASSERT_EQ(both.width, left.width);
  ASSERT_EQ(both.height, 2 * left.height);
  Image joined = left, swapped = right;
  joined.height = swapped.height = both.height;
  joined.data.insert(joined.data.end(), right.data.begin(), right.data.end());
  swapped.data.insert(swapped.data.end(), left.data.begin(), left.data.end());
  EXPECT_EQ(measure::largest_difference(both, joined).max, 0.0);
  EXPECT_GT(measure::largest_difference(both, swapped).max, 0.0) << "swapped eyes go unnoticed";
  EXPECT_NE(read_text(out + "/front.png").find("over-under"), std::string::npos) << "no note of the layout";
}

TEST_F(Layout, AnExrFileHasBothEyesAsViews) {
  ASSERT_TRUE(good(render({"-o", folder / "pair.exr", "--exr", "float"})));
  ASSERT_TRUE(good(render({"-o", out, "--layout", "multi-view", "--background", "none"})));
  EXPECT_EQ(folder.files(), (Names{"cameras.json", "model.ply", "pair.exr", "out/front.exr"}));
  for (const char* name : {"multiView", "right.R", "right.Z", "right.coverage"})
    EXPECT_NE(read_text(folder / "pair.exr").find(name), std::string::npos) << name;
  ASSERT_TRUE(good(render({"-o", folder / "left.png", "--only", "left", "--bits", "16"})));
  ASSERT_TRUE(good(render({"-o", folder / "right.png", "--only", "right", "--bits", "16"})));
  const auto psnr = [&](const char* eye) {
    return measure::psnr(load_image(folder / "pair.exr"), load_image(folder / eye));
  };
  EXPECT_GT(psnr("left.png"), 90.0);
  EXPECT_LT(psnr("right.png"), 60.0) << "the right eye as the default view goes unnoticed";
}

TEST_F(Layout, WhatDoesNotGoTogetherIsRefused) {
  const auto refused = [&](std::vector<std::string> arguments, const std::string& said) {
    return ended(render(std::move(arguments)), 2, said);
  };
  const std::string png = folder / "a.png", exr = folder / "a.exr";
  EXPECT_TRUE(refused({"--layout", "rows", "--mono"}, "--layout rows needs both eyes"));
  EXPECT_TRUE(refused({"--layout", "rows", "--only", "left"}, "--layout rows needs both eyes"));
  EXPECT_TRUE(refused({"--layout", "separate", "-o", png}, "must be a folder"));
  EXPECT_TRUE(refused({"--layout", "multi-view", "-o", png}, "is OpenEXR's"));
  EXPECT_TRUE(refused({"--layout", "multi-view", "--bits", "8"}, "--bits is for PNG"));
  EXPECT_TRUE(refused({"--layout", "anaglyph", "-o", exr}, "write PNG only"));
  EXPECT_TRUE(refused({"--layout", "grey", "--exr", "half"}, "write PNG only"));
  EXPECT_TRUE(
      refused({"--layout", "half-colour", "--background", "none"}, "--background none is not for it"));
  EXPECT_TRUE(refused({"--layout", "half-width", "--size", "75x48"}, "even width"));
  EXPECT_TRUE(refused({"--layout", "sideways"}, "sideways"));
  EXPECT_TRUE(refused({"--layout", "quad-buffer"}, "binosplat view"));
  const nlohmann::json small = [] {
    nlohmann::json camera = test::camera_json("odd_right", 0.1);
    camera["width"] = 70;
    return camera;
  }();
  test::write_text(folder / "cameras.json",
                   nlohmann::json({test::camera_json("odd_left", -0.1), small}).dump());
  EXPECT_TRUE(refused({"-o", png}, "72 x 48 and 70 x 48 px"));
  EXPECT_EQ(folder.files(), (Names{"cameras.json", "model.ply"}));
}

TEST_F(Layout, DisparityIsToldAndWarnedOf) {
  // The model begins 2.5 to 3 units away: 0.6 degrees with eyes 0.03 apart, 4 with eyes 0.2 apart.
  const Outcome plain = render({"-o", out, "--json", folder / "r.json", "--ipd", "0.03"});
  ASSERT_TRUE(good(plain));
  EXPECT_NE(plain.out.find("disparity"), std::string::npos) << plain.out;
  EXPECT_EQ(plain.err.find("tire most eyes"), std::string::npos) << plain.err;
  EXPECT_GT(disparity()["near_px"].get<double>(), 60.0 * 0.03 / 3.0);
  EXPECT_LT(disparity()["near_px"].get<double>(), 60.0 * 0.03 / 2.5);
  EXPECT_TRUE(disparity()["comfortable"].get<bool>());

  const Outcome wide = render({"-o", out, "--json", folder / "r.json", "--ipd", "0.2"});
  ASSERT_TRUE(good(wide));
  EXPECT_NE(wide.err.find("tire most eyes"), std::string::npos) << wide.err;
  EXPECT_FALSE(disparity()["comfortable"].get<bool>());
  // What the warning proposes is within.
  const std::size_t at = wide.err.find("--convergence ");
  ASSERT_NE(at, std::string::npos) << wide.err;
  std::istringstream words(wide.err.substr(at, wide.err.find(" is within") - at));
  std::vector<std::string> options{"-o", out, "--json", folder / "r.json"};
  for (std::string word; words >> word;) options.push_back(word);
  if (wide.err.find("--ipd") == std::string::npos) options.insert(options.end(), {"--ipd", "0.2"});
  const Outcome better = render(options);
  ASSERT_TRUE(good(better));
  EXPECT_LE(disparity()["near_degrees"].get<double>(), 1.0);
  EXPECT_GE(disparity()["far_degrees"].get<double>(), -1.0);

  ASSERT_TRUE(good(render({"-o", out, "--json", folder / "r.json", "--mono"})));
  EXPECT_TRUE(disparity().is_null());
}

TEST_F(Layout, AScreenStandsWhereItSuitsTheFirstView) {
  const std::string png = folder / "pair.png";
  const auto draw = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--ipd", "0.1", "--json", folder / "r.json"});
    Outcome outcome = render(arguments);
    EXPECT_TRUE(good(outcome));
    return outcome;
  };
  const auto metres = [&](std::size_t view) {
    return nlohmann::json::parse(read_text(folder / "r.json"))["views"][view]["convergence_metres"];
  };
  const Outcome plain = draw({"-o", png});
  EXPECT_NE(plain.err.find("--convergence METRES for another"), std::string::npos) << plain.err;
  EXPECT_EQ(plain.err.find("tire most eyes"), std::string::npos) << plain.err;
  ASSERT_TRUE(metres(0).is_number());
  EXPECT_TRUE(disparity()["comfortable"].get<bool>()) << disparity();
  EXPECT_NEAR(disparity()["focus_metres"].get<double>(), metres(0).get<double>(), 1e-9);
  EXPECT_GT(disparity()["near_degrees"].get<double>(), 0.0);
  EXPECT_LT(disparity()["far_degrees"].get<double>(), 0.0);
  const Image suited = load_image(png);

  // The option says the same, comes first, and may say that there is none.
  draw({"-o", png, "--convergence", metres(0).dump()});
  EXPECT_EQ(measure::largest_difference(load_image(png), suited).max, 0.0);
  const Outcome infinite = draw({"-o", png, "--convergence", "inf"});
  EXPECT_GT(measure::largest_difference(load_image(png), suited).max, 0.1);
  EXPECT_TRUE(metres(0).is_null());
  EXPECT_NE(infinite.err.find("tire most eyes"), std::string::npos) << infinite.err;

  // Headsets, canted eyes, single eyes and files for each eye have no screen.
  using Arguments = std::vector<std::string>;
  for (const Arguments& other : {Arguments{"-o", out}, Arguments{"-o", folder / "pair.exr"},
                                 Arguments{"-o", png, "--cant", "1"}, Arguments{"-o", png, "--only", "left"},
                                 Arguments{"-o", png, "--preset", "headset", "--size", "72x48"}}) {
    const Outcome outcome = draw(other);
    EXPECT_TRUE(metres(0).is_null()) << outcome.err;
    EXPECT_EQ(outcome.err.find("for another"), std::string::npos) << outcome.err;
    // Only who can change it is warned.
    const bool warned = outcome.err.find("tire most eyes") != std::string::npos;
    EXPECT_EQ(warned, other.size() == 2) << outcome.err;
  }

  // One for all views, and for all parts of a run.
  draw({"-o", out, "--layout", "parallel", "--view", "front", "side"});
  const auto of_front = metres(0);
  EXPECT_EQ(metres(1), of_front);
  draw({"-o", out, "--layout", "parallel", "--view", "front", "side", "--shard", "1/2"});
  EXPECT_EQ(metres(0), of_front);
  draw({"-o", out, "--layout", "parallel", "--view", "side"});
  EXPECT_NE(metres(0), of_front) << "any view has this one";
}

}  // namespace
}  // namespace binosplat
