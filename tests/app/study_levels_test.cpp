// binosplat study --levels, as a user runs it.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/scene.h"
#include "support/fixtures.h"
#include "support/models.h"

namespace binosplat {
namespace {

using test::ended;
using test::good;
using test::Outcome;
using test::run_program;
using Arguments = std::vector<std::string>;

struct StudyLevels : test::SceneTest {
  /// A folder of levels, with cameras in it.
  std::string make_levels(const std::string& name, bool cameras = true) {
    std::string made = folder / name;
    EXPECT_TRUE(good(run_program({"levels", model, "-o", made, "--leaf", "64", "--levels", "4"})));
    if (cameras) {
      add_row_of_cameras(3);
      std::filesystem::rename(folder / "cameras.json", folder / (name + "/cameras.json"));
    }
    return made;
  }

  Outcome study(const Arguments& scenes, const Arguments& more = {}) const {
    Arguments all = {"study"};
    all.insert(all.end(), scenes.begin(), scenes.end());
    all.insert(all.end(), {"--levels", "--frames", "1", "--ipd", "0.1"});
    all.insert(all.end(), more.begin(), more.end());
    return run_program(all);
  }
};

TEST_F(StudyLevels, TellWhatRenderTells) {
  test::save_ply(model, test::random_model(4, 1500, 0));
  const std::string made = make_levels("made");
  const Outcome outcome = study({made}, {"--detail", "25dB,35dB", "-o", out});
  ASSERT_TRUE(good(outcome));
  const auto scene = test::load_json(out + "/study.json").at("scenes").at(0);
  EXPECT_EQ(scene["finest_gaussians"], 1500);
  EXPECT_EQ(scene["eyes"], 2);
  ASSERT_EQ(scene["rows"].size(), 3u);
  EXPECT_EQ(scene["rows"][1]["detail"], 35.0);
  EXPECT_FALSE(scene["rows"][2].contains("detail")) << "the finest";
  EXPECT_NE(outcome.out.find("\n| " + made + " | 35.00 | "), std::string::npos) << outcome.out;
  EXPECT_NE(test::read_text(out + "/report.html").find("What frames take"), std::string::npos);

  ASSERT_TRUE(good(run_program({"render", made, "--view", "all", "--detail", "35dB", "--detail-report",
                                "--ipd", "0.1", "-o", folder / "r", "--json", folder / "r.json"})));
  const auto rendered = test::load_json(folder / "r.json").at("views");
  const auto views = scene["rows"][1]["views"], coarser = scene["rows"][0]["views"];
  ASSERT_EQ(views.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& levels = rendered[k]["levels_of_detail"];
    EXPECT_EQ(views[k]["name"], rendered[k]["name"]);
    EXPECT_EQ(views[k]["gaussians"], levels["gaussians"]);
    EXPECT_EQ(views[k]["predicted_psnr_db"], levels["predicted_psnr_db"]);
    const double psnr = levels["finest_psnr_db"];
    EXPECT_NEAR(views[k]["psnr_db"].get<double>(), psnr, 0.01);
    // Planted: other levels are not the same.
    EXPECT_GT(std::abs(coarser[k]["psnr_db"].get<double>() - psnr), 1.0);
    EXPECT_GT(coarser[k]["flip"], views[k]["flip"]);
    EXPECT_LT(coarser[k]["disagreement_db"], views[k]["disagreement_db"]);
  }
}

TEST_F(StudyLevels, OfSeveralScenesTellHowTimesGrow) {
  const std::string small = make_levels("small");
  test::save_ply(model, test::random_model(2, 900, 1));
  const std::string large = make_levels("large", false);
  const Outcome outcome =
      study({small, large}, {"--detail", "30dB", "--cameras", small + "/cameras.json", "--view", "view2",
                             "--mono", "--size", "36x24", "--json", folder / "s.json"});
  ASSERT_TRUE(good(outcome));
  const auto scenes = test::load_json(folder / "s.json").at("scenes");
  ASSERT_EQ(scenes.size(), 2u);
  EXPECT_EQ(scenes[1]["finest_gaussians"], 900);
  EXPECT_EQ(scenes[1]["rows"][0]["views"][0]["name"], "view2");
  EXPECT_EQ(scenes[1]["width"], 36);
  EXPECT_FALSE(scenes[1]["rows"][0]["mean"].contains("disagreement_db")) << "one eye";
  EXPECT_NE(outcome.out.find("\n| " + large + " | 0.900 | 3.000 | "), std::string::npos) << outcome.out;
}

TEST_F(StudyLevels, ByPixelsPredictNothing) {
  const std::string made = make_levels("made");
  ASSERT_TRUE(good(study({made}, {"--detail", "20,2", "--view", "view1", "--json", folder / "s.json"})));
  const auto json = test::load_json(folder / "s.json");
  EXPECT_EQ(json["detail_unit"], "px");
  const auto rows = json["scenes"][0]["rows"];
  EXPECT_EQ(rows[0]["detail"], 2.0);
  EXPECT_GT(rows[0]["mean"]["gaussians"], rows[1]["mean"]["gaussians"]);
  EXPECT_FALSE(rows[1]["mean"].contains("predicted_psnr_db"));
}

TEST_F(StudyLevels, WhatIsWrongIsNamed) {
  const std::string made = make_levels("made", false);
  add_cameras();
  EXPECT_TRUE(ended(study({model}), 2, model + " is no folder with levels of detail"));
  EXPECT_TRUE(ended(study({"demo:room"}), 2, "`binosplat levels MODEL -o DIR` makes one"));
  EXPECT_TRUE(
      ended(study({made, folder / "gone"}, {"--cameras", folder / "cameras.json"}), 2, "gone is no folder"));
  EXPECT_TRUE(ended(study({made}), 2, "no cameras beside " + made));
  const std::string cameras = folder / "cameras.json";
  const std::vector<std::pair<Arguments, std::string>> wrong = {
      {{"--view", "no-such"}, "--view no-such"},
      {{"--view", "pair", "--mono"}, "pair_left"},
      {{"--detail", "40dB,5"}, "all of them in pixels, or all in decibels"},
      {{"--detail", "40db,x"}, "--detail x: expected"},
      {{"--detail", "90dB"}, "--detail 90dB"},
      {{"--count", "1000"}, "--count"},
      {{"--turn"}, "are studies of their own"},
      {{"--photos", folder / "."}, "--photos"},
      {{"--target", "30"}, "--target"},
      {{"--rays", "4x3"}, "--rays goes with --turn"},
  };
  for (const auto& [options, message] : wrong) {
    Arguments all = {"--cameras", cameras};
    all.insert(all.end(), options.begin(), options.end());
    EXPECT_TRUE(ended(study({made}, all), 2, message));
  }
  // Without what its levels lose.
  const std::string meta = made + "/lod-meta.json";
  auto without = test::load_json(meta);
  const std::function<void(nlohmann::json&)> forget = [&](nlohmann::json& node) {
    node.erase("pixels");
    if (node.contains("children")) {
      for (auto& child : node["children"]) forget(child);
    }
  };
  forget(without["tree"]);
  test::write_text(meta, without.dump());
  EXPECT_TRUE(ended(study({made}, {"--cameras", cameras}), 2, "has no errors of its levels to go by"));
  EXPECT_TRUE(ended(run_program({"study", made, "--detail", "40dB"}), 2, "--levels"));
  EXPECT_TRUE(ended(run_program({"study", model, model, "--turn"}), 2, "--turn is a study of one scene"));
}

}  // namespace
}  // namespace binosplat
