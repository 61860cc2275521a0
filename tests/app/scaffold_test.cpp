// binosplat render of a Scaffold-GS model, as users run it.

#include "app/scene.h"
#include "formats/image_file.h"
#include "support/scaffold_files.h"

namespace binosplat {
namespace {

using test::good;
using test::has;
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
  EXPECT_TRUE(
      has(outcome.err, "Scaffold-GS, 100 anchors of 10 Gaussians, features of 32, appearance 0 of 0 to 2"));
  EXPECT_TRUE(has(outcome.out, "decode"));
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
  EXPECT_TRUE(has(outcome.out, "point_cloud.ply (Scaffold-GS, 100 anchors of 10 Gaussians"));
  EXPECT_FALSE(has(outcome.out, "never visible")) << "said of stand-ins";
  const auto json = nlohmann::json::parse(read_text(folder / "info.json"));
  EXPECT_EQ(json["gaussians"], 1000);
  EXPECT_FALSE(json.contains("opacity"));
}

}  // namespace
}  // namespace binosplat
