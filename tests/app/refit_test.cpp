// binosplat refit.

#include "app/scene.h"
#include "formats/image_file.h"
#include "formats/model_file.h"
#include "support/fixtures.h"
#include "support/models.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

using nlohmann::json;
using test::ended;
using test::good;
using test::Outcome;
using test::run_program;

Model colourful() {
  Model model = test::random_model(71, 500, 1);
  for (std::size_t k = 0; k < model.sh.size(); ++k) model.sh[k] *= k % 12 < 3 ? 0.5f : 0.1f;
  return model;
}

struct RefitTest : test::SceneTest {
  RefitTest() {
    add_row_of_cameras(8);
    test::save_ply(model, colourful());
  }

  /// Pictures of the model as it is now, as photos of the views.
  void take_photos(const std::filesystem::path& to) const {
    ASSERT_TRUE(good(run_program({"render", model, "--mono", "--view", "all", "-o", to})));
  }

  Outcome refit(const std::string& to, std::vector<std::string> more) const {
    more.insert(more.begin(), {"refit", model, "-o", folder / to, "--json", folder / "r.json"});
    return run_program(more);
  }
  json steps() const { return test::load_json(folder / "r.json")["steps"]; }
};

TEST_F(RefitTest, BringsThePhotosBack) {
  take_photos(folder / "photos");
  Model darker = colourful();
  for (float& c : darker.sh) c -= 0.2f;
  test::save_ply(model, darker);
  const Outcome outcome = refit("m.ply", {"--photos", folder / "photos", "--views", "2", "--test", "view3"});
  ASSERT_TRUE(good(outcome));
  const json all = steps();
  ASSERT_EQ(all.size(), 3u) << outcome.out;
  const double before = all[0]["held_back_db"], after = all[2]["held_back_db"], test = all[2]["test_db"];
  EXPECT_GT(after, before + 10.0);
  EXPECT_GT(test, before + 10.0);
  EXPECT_NE(outcome.out.find("6 views fitted, 6 of them to photos; 1 held back, 1 of test"),
            std::string::npos)
      << outcome.out;
  const Model found = load_model(folder / "m.ply");
  EXPECT_EQ(found.position, darker.position);
  EXPECT_EQ(found.opacity, load_model(model).opacity);
  EXPECT_EQ(found.perspective, Perspective{});

  EXPECT_EQ(test::load_json(folder / "r.json")["written"], true);
  // A view without a photo is fitted to the model's own picture.
  std::filesystem::remove(folder / "photos" / "view5.png");
  const Outcome fewer = refit("n.ply", {"--photos", folder / "photos"});
  ASSERT_TRUE(good(fewer));
  EXPECT_NE(fewer.out.find("7 views fitted, 6 of them to photos; 1 held back"), std::string::npos)
      << fewer.out;
}

TEST_F(RefitTest, ForAnotherOrderAndProjection) {
  ASSERT_TRUE(good(refit("m.ply", {"--against", "exact", "--order", "distance", "--projection", "tangent",
                                   "--held-back", "view2,view4"})));
  EXPECT_EQ(test::load_json(folder / "r.json")["held_back"], json({"view2", "view4"}));
  const json all = steps();
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[0]["held_back_db"], 100.0);
  EXPECT_GT(all[3]["held_back_db"], all[1]["held_back_db"]);
  EXPECT_EQ(load_model(folder / "m.ply").perspective, (Perspective{ORDER_DISTANCE, PROJECTION_TANGENT}));
}

TEST_F(RefitTest, WritesNothingThatIsWorse) {
  const Outcome same = refit("m.ply", {"--against", "exact"});
  EXPECT_TRUE(ended(same, 1, "no nearer than before, 100.000 dB"));
  EXPECT_FALSE(std::filesystem::exists(folder / "m.ply"));
  // The format costs more than the fit gains.
  const Outcome coarse = refit("m.sog", {"--against", "exact", "--order", "distance"});
  EXPECT_TRUE(ended(coarse, 1, "m.sog is not written"));
  EXPECT_FALSE(std::filesystem::exists(folder / "m.sog"));
}

TEST_F(RefitTest, WhatMakesNoSenseIsNamed) {
  take_photos(folder / "one");
  for (int i = 1; i < 8; ++i) std::filesystem::remove(folder / "one" / ("view" + std::to_string(i) + ".png"));
  EXPECT_TRUE(
      ended(refit("m.ply", {"--photos", folder / "one"}), 2, "the only photo of a view is held back"));
  EXPECT_TRUE(ended(refit("m.ply", {}), 2, "--photos DIR, or --against exact"));
  EXPECT_TRUE(ended(refit("m.ply", {"--against", "exact", "--photos", folder.path()}), 2, "--against exact"));
  EXPECT_TRUE(ended(refit("m.png", {"--against", "exact"}), 2, "m.png"));
  EXPECT_TRUE(ended(refit("m.ply", {"--against", "exact", "--sh-bits", "4"}), 2, "only spz"));
  EXPECT_TRUE(ended(refit("m.ply", {"--against", "photos"}), 2, "photos"));
  EXPECT_TRUE(ended(refit("m.ply", {"--photos", folder / "none"}), 2, "none"));
  EXPECT_TRUE(ended(refit("m.ply", {"--photos", folder.path()}), 2, "there is no photo of any view"));
  EXPECT_TRUE(ended(refit("m.ply", {"--against", "exact", "--test", "nowhere"}), 2, "--test nowhere: "));
  EXPECT_TRUE(ended(refit("m.ply", {"--against", "exact", "--test", "view1", "--held-back", "view1"}), 2,
                    "--held-back view1: named twice"));
  std::filesystem::remove(folder / "cameras.json");
  EXPECT_TRUE(ended(refit("m.ply", {"--against", "exact"}), 2, "refit needs the cameras"));
  std::filesystem::remove(model);
  EXPECT_TRUE(ended(refit("m.ply", {"--against", "exact"}), 2, "cannot read " + model));
}

// A trained model, in small pictures: a few rounds over a few views.
TEST(RefitScenes, FoxByDistanceGetsNearItsPictures) {
  if (!test::switched_on("BINOSPLAT_LONG")) GTEST_SKIP() << "half a minute: set BINOSPLAT_LONG=1";
  REQUIRE_SCENE("fox", scene);
  test::TempFolder folder;
  json some;
  for (const json& camera : test::load_json(scene / "cameras.json")) {
    if (camera["id"].get<int>() % 7 == 0) some.push_back(camera);
  }
  test::write_text(folder / "cameras.json", some.dump());
  ASSERT_TRUE(good(run_program({"refit",        scene / "fox_pruned.ply",
                                "--cameras",    folder / "cameras.json",
                                "--against",    "exact",
                                "--order",      "distance",
                                "--projection", "tangent",
                                "--size",       "130x236",
                                "--rounds",     "3",
                                "--views",      "2",
                                "-o",           folder / "m.ply",
                                "--json",       folder / "r.json"})));
  const json steps = test::load_json(folder / "r.json")["steps"];
  EXPECT_GT(steps[3]["held_back_db"].get<double>(), steps[1]["held_back_db"].get<double>() + 1.0);
}

}  // namespace
}  // namespace binosplat
