// binosplat render of a Scaffold-GS model, as users run it.

#include "app/scene.h"
#include "formats/image_file.h"
#include "support/scaffold_files.h"

namespace binosplat {
namespace {

using test::ended;
using test::good;
using test::Outcome;
using test::read_text;
using test::run_program;

/// A trained model's folder, its cameras beside point_cloud/.
struct ScaffoldFolder : testing::Test {
  test::TempFolder folder;
  const std::filesystem::path latest = folder / "point_cloud/iteration_30000";
  const std::filesystem::path out = folder / "out";

  ScaffoldFolder() {
    std::filesystem::create_directories(latest);
    test::write_scaffold(latest, test::random_scaffold(1, {.anchors = 100, .appearances = 3}));
    const nlohmann::json cameras = {test::camera_json("front", 0.0)};
    test::write_text(folder / "cameras.json", cameras.dump());
  }

  Outcome render(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"render", folder.path()});
    return run_program(arguments);
  }
  /// A picture's pixels; its texts name the scene as it was given.
  std::vector<float> picture(const std::string& name) const { return load_image(out / name).data; }
};

TEST_F(ScaffoldFolder, IsDrawnFromItsOwnCameras) {
  const Outcome outcome = render({"-o", out, "--json", folder / "report.json"});
  ASSERT_TRUE(good(outcome));
  EXPECT_NE(
      outcome.err.find("Scaffold-GS, 100 anchors of 10 Gaussians, features of 32, appearance 0 of 0 to 2"),
      std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.out.find("decode"), std::string::npos) << outcome.out;
  const auto report = nlohmann::json::parse(read_text(folder / "report.json"));
  EXPECT_EQ(report["scene"]["scaffold"]["anchors"], 100);
  EXPECT_EQ(report["scene"]["scaffold"]["appearances"], 3);
  EXPECT_EQ(report["settings"]["decode"], "eyes");
  const std::vector<float> left = picture("front_left.png"), right = picture("front_right.png");
  // The ply itself names the same model; each eye is the same alone.
  ASSERT_TRUE(good(run_program({"render", latest / "point_cloud.ply", "--only", "right", "-o", out})));
  EXPECT_TRUE(picture("front_right.png") == right);
  EXPECT_FALSE(left == right);
}

TEST_F(ScaffoldFolder, AppearancesAndDecodingsMakeOtherPictures) {
  const auto draw = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"-o", out, "--ipd", "0.3"});
    EXPECT_TRUE(good(render(more)));
    return picture("front_left.png");
  };
  const std::vector<float> plain = draw({});
  EXPECT_TRUE(draw({"--appearance", "0", "--decode", "eyes"}) == plain);
  EXPECT_FALSE(draw({"--appearance", "2"}) == plain);
  EXPECT_FALSE(draw({"--decode", "cyclopean"}) == plain);
  EXPECT_FALSE(draw({"--repeat", "2x1", "--spacing", "1"}) == plain);
}

TEST_F(ScaffoldFolder, InfoSaysWhatItIs) {
  const Outcome outcome = run_program({"info", folder.path(), "--json", folder / "info.json"});
  ASSERT_TRUE(good(outcome));
  EXPECT_NE(outcome.out.find("point_cloud.ply (Scaffold-GS, 100 anchors of 10 Gaussians"), std::string::npos);
  EXPECT_EQ(outcome.out.find("never visible"), std::string::npos) << "said of stand-ins";
  const auto json = nlohmann::json::parse(read_text(folder / "info.json"));
  EXPECT_EQ(json["gaussians"], 1000);
  EXPECT_FALSE(json.contains("opacity"));
}

TEST_F(ScaffoldFolder, OptionsThatHaveNoEffectAreRefused) {
  EXPECT_TRUE(ended(render({"--appearance", "3", "-o", out}), 2, "has appearances 0 to 2"));
  EXPECT_TRUE(ended(render({"--decode", "cyclopean", "--mono", "-o", out}), 2, "--decode cyclopean"));
  EXPECT_TRUE(
      ended(run_program({"render", "demo:room", "--appearance", "0"}), 2, "--appearance is for model files"));
  EXPECT_TRUE(ended(run_program({"render", "demo:room", "--decode", "eyes"}), 2, "no Scaffold-GS"));
  test::write_text(folder / "plain.ply", to_bytes(test::small_model()));
  EXPECT_TRUE(ended(run_program({"render", folder / "plain.ply", "--appearance", "0"}), 2, "no Scaffold-GS"));
  std::filesystem::remove(latest / "cov_mlp.pt");
  EXPECT_TRUE(ended(render({"-o", out}), 2, "cov_mlp.pt is missing"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace binosplat
