// Runs binosplat render with a Scaffold-GS model, like users.

#include "app/scene.h"
#include "support/scaffold_files.h"

namespace binosplat {
namespace {

/// The folder of a trained model, with its cameras outside point_cloud/.
struct ScaffoldFolder : SceneTest {
  const std::string latest = folder / "point_cloud/iteration_30000", report = folder / "report.json";

  ScaffoldFolder() {
    fs::remove(model);
    fs::create_directories(latest);
    test::write_scaffold(latest, test::random_scaffold(1, {.anchors = 100, .appearances = 3}));
    save("cameras.json", json({camera_json("front", 0.0)}));
  }

  Outcome render(const Words& words) const {
    return run_into_out(joined({"render", folder.path(), "--json", report}, words));
  }
  /// Returns a picture's pixels, because the texts in its file differ.
  std::vector<float> picture(const std::string& name) const { return load_image(out + "/" + name).data; }
};

TEST_F(ScaffoldFolder, UsesOwnCameras) {
  const Outcome outcome = render({});
  ASSERT_TRUE(
      ended(outcome, 0, "Scaffold-GS, 100 anchors of 10 Gaussians, features of 32, appearance 0 of 0 to 2"));
  EXPECT_TRUE(has(outcome.out, "decode"));
  const json run = load_json(report);
  EXPECT_EQ(run["scene"]["scaffold"]["anchors"], 100);
  EXPECT_EQ(run["scene"]["scaffold"]["appearances"], 3);
  const std::vector<float> left = picture("front_left.png"), right = picture("front_right.png");
  // The ply's path names the same model. Each eye alone gives the same picture.
  ASSERT_TRUE(good(run_into_out({"render", latest + "/point_cloud.ply", "--only", "right"})));
  EXPECT_TRUE(picture("front_right.png") == right);
  EXPECT_FALSE(left == right);
}

TEST_F(ScaffoldFolder, AppearanceChangesPicture) {
  const auto draw = [&](const Words& words) {
    EXPECT_TRUE(good(render(joined(words, {"--ipd", "0.3"}))));
    return picture("front_left.png");
  };
  const std::vector<float> plain = draw({});
  EXPECT_TRUE(draw({"--appearance", "0"}) == plain);
  EXPECT_FALSE(draw({"--appearance", "2"}) == plain);
  EXPECT_FALSE(draw({"--repeat", "2x1", "--spacing", "1"}) == plain);
}

TEST_F(ScaffoldFolder, InfoDescribesModel) {
  const Outcome outcome = checked(run_program({"info", folder.path(), "--json", report}));
  EXPECT_TRUE(has(outcome.out, "point_cloud.ply (Scaffold-GS, 100 anchors of 10 Gaussians"));
  EXPECT_FALSE(has(outcome.out, "never visible")) << "said of stand-ins";
  EXPECT_EQ(load_json(report)["gaussians"], 1000);
  EXPECT_FALSE(load_json(report).contains("opacity"));
}

}  // namespace
}  // namespace binosplat
