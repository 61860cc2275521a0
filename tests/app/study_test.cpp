// binosplat study, as a user runs it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/scene.h"
#include "support/fixtures.h"
#include "support/program.h"

namespace binosplat {
namespace {

TEST(Study, APathIsCarriedAndTold) {
  const test::TempFolder folder;
  std::string frames;
  for (int n = 0; n < 3; ++n) {
    frames += fmt::format(R"({}{{"img_name": "frame_{}", "width": 96, "height": 54, "fx": 60, "fy": 60,
      "position": [{}, -1.5, -1], "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}})",
                          n > 0 ? "," : "", n, 0.005 * n);
  }
  test::write_text(folder / "path.json", "[" + frames + "]");
  const test::Outcome outcome =
      test::run_program({"study", "demo:room", "--path", folder / "path.json", "--transmittance", "last",
                         "--tolerance", "0.05", "--json", folder / "s.json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("fell back: equals `one`"), std::string::npos) << outcome.out;
  const auto json = nlohmann::json::parse(test::read_text(folder / "s.json"));
  ASSERT_EQ(json.at("frames").size(), 3u);
  EXPECT_EQ(json.at("variant"), "squared, last");
  EXPECT_GT(json.at("frames")[2].at("removed").get<double>(), 0.0);
}

// What frames of a file of the same 1000 Gaussians come to.
nlohmann::json carried(const test::TempFolder& folder, const std::string& model) {
  const test::Outcome outcome = test::run_program(
      {"study", model, "--path", folder / "path.json", "--tolerance", "0.05", "--json", folder / "s.json"});
  EXPECT_TRUE(test::good(outcome));
  return nlohmann::json::parse(test::read_text(folder / "s.json")).at("frames");
}

TEST(Study, CamerasEnterTheModelsFrame) {
  REQUIRE_FIXTURES(fixtures);
  const test::TempFolder folder;
  nlohmann::json path;
  for (int n = 0; n < 2; ++n) {
    path.push_back(test::camera_json(fmt::format("frame_{}", n), 0.0));
    path.back()["position"] = {2.0 + 0.01 * n, 3.0, -10.0};
  }
  test::write_text(folder / "path.json", path.dump());
  const auto ply = carried(folder, fixtures / "ply/inria-train-1000.ply");
  const auto gltf = carried(folder, fixtures / "gltf/st-train-sh3.glb");  // x left, y up
  for (std::size_t n = 0; n < 2; ++n) {
    const double pairs = ply[n].at("pairs").get<double>();
    EXPECT_GT(pairs, 100.0);
    EXPECT_NEAR(gltf[n].at("pairs").get<double>(), pairs, 0.01 * pairs);
  }
}

struct RulesCommand : test::SceneTest {
  RulesCommand() { add_cameras(); }

  std::string printed, logged;

  nlohmann::json rules(std::vector<std::string> more) {
    more.insert(more.begin(), {"study", model, "--rules", "--frames", "1", "--json", folder / "r.json"});
    const test::Outcome outcome = test::run_program(more);
    EXPECT_TRUE(test::good(outcome));
    printed = outcome.out;
    logged = outcome.err;
    return nlohmann::json::parse(test::read_text(folder / "r.json"));
  }
};

TEST_F(RulesCommand, PrintsARowForEachRuleAndKeepsAll) {
  // Some rules have no tolerance that makes pictures of 10 dB, which is no reason to end.
  const auto json = rules({"--view", "pair", "--target", "10"});
  const std::string renderer = json.at("renderer");
  EXPECT_EQ(printed.rfind(renderer + ": " + model + ", pair, 2 x 72 x 48 px, 10 dB\n", 0), 0u) << printed;
  ASSERT_EQ(json.at("rules").size(), 7u);
  for (const auto& rule : json.at("rules")) {
    const std::string name = rule.at("name");
    SCOPED_TRACE(name);
    const auto row = printed.find("\n| " + name + " | ");
    ASSERT_NE(row, std::string::npos) << printed;
    const std::string cells = printed.substr(row + 1, printed.find('\n', row + 1) - row - 1);
    EXPECT_EQ(std::count(cells.begin(), cells.end(), '|'), 18);
    const double ms = rule.at("frame_ms");
    EXPECT_NE(cells.find(fmt::format(" {:.3f} |", ms)), std::string::npos) << cells;
    EXPECT_GT(rule.at("stages_ms").at("blend").get<double>(), 0.0);
    const std::string problem = rule.value("problem", "");
    const bool is_met = name == "tau" || std::abs(rule.at("psnr_db").get<double>() - 10.0) <= 0.3;
    EXPECT_EQ(problem, is_met ? "" : "not within 0.3 dB of 10 dB");
    EXPECT_NE(cells.find("| " + problem + " |"), std::string::npos) << cells;
  }
}

TEST_F(RulesCommand, ATurnedHeadIsMeasuredAgainstPhotosToo) {
  const std::string photos = folder / "photos";
  ASSERT_TRUE(test::good(test::run_program({"render", model, "--mono", "--view", "all", "--order", "distance",
                                            "--projection", "tangent", "-o", photos})));
  const test::Outcome outcome =
      test::run_program({"study", model, "--turn", "--view", "front", "--rays", "4x3", "--photos", photos,
                         "--ipd", "0.1", "-o", folder / "page"});
  ASSERT_TRUE(test::good(outcome));
  const auto json =
      nlohmann::json::parse(test::read_text(std::filesystem::path(folder / "page") / "study.json"));
  EXPECT_EQ(json.at("columns"), 4);
  EXPECT_EQ(json.at("turns").size(), 60u);
  ASSERT_EQ(json.at("perspectives").size(), 4u);
  EXPECT_LT(json.at("perspectives")[0].at("photos_db").get<double>(), 70.0);
  EXPECT_TRUE(json.at("perspectives")[3].at("photos_db").is_null()) << "equal: the photos are of these";
  EXPECT_GT(json.at("perspectives")[0].at("disagreement_db").get<double>(), 20.0);
  EXPECT_NE(outcome.out.find("Against 4 photos"), std::string::npos) << outcome.out;
}

TEST_F(RulesCommand, DrawsTheOneView) {
  const auto json = rules({"--view", "front", "--mono", "--target", "36"});
  EXPECT_EQ(json.at("eyes"), 1);
  EXPECT_EQ(printed.find("nan"), std::string::npos) << printed;
  ASSERT_EQ(json.at("rules").size(), 7u);
  EXPECT_TRUE(json.at("rules")[0].at("psnr_db").is_null());
  EXPECT_EQ(json.at("rules")[0].at("pairs_removed"), 0.0);
  for (std::size_t k = 1; k < 7; ++k) {
    const auto& rule = json.at("rules")[k];
    EXPECT_TRUE(rule.at("disagreement_db").is_null());
    const bool near = std::abs(rule.at("psnr_db").get<double>() - 36.0) <= 0.3;
    EXPECT_EQ(near, !rule.contains("problem")) << rule;
  }
}

TEST_F(RulesCommand, PutsARigOnACameraWithALensOfAPreset) {
  const auto exact_pairs = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--view", "front", "--size", "61x53", "--target", "10"});
    const auto json = rules(more);
    EXPECT_EQ(json.at("eyes"), 2);
    EXPECT_EQ(json.at("width"), 61);
    return json.at("rules")[0].at("pairs").get<double>();
  };
  EXPECT_LT(exact_pairs({"--preset", "headset"}), exact_pairs({}));
}

TEST_F(RulesCommand, MetresAreThoseOfTheOption) {
  std::filesystem::remove(folder / "cameras.json");
  test::save_ply(model, test::floor_model());
  rules({"--size", "36x24", "--target", "10", "--units-per-metre", "0.5"});
  EXPECT_NE(logged.find("from 0.8 units above the ground"), std::string::npos) << logged;
}

struct AnalysesCommand : test::SceneTest {
  AnalysesCommand() { add_cameras(); }
};

TEST_F(AnalysesCommand, LeavesAPageAndItsNumbers) {
  const test::Outcome outcome = test::run_program(
      {"study", model, "--view", "front", "--test", "side", "--size", "36x24", "--frames", "1", "-o", out});
  ASSERT_TRUE(test::good(outcome));
  const auto json = nlohmann::json::parse(test::read_text(out + "/study.json"));
  EXPECT_EQ(json.at("target"), "quality");
  EXPECT_EQ(json.at("width"), 36);
  EXPECT_EQ(json.at("views").at("calibration"), nlohmann::json({"front"}));
  EXPECT_EQ(json.at("views").at("test"), nlohmann::json({"side"}));
  EXPECT_EQ(json.at("targets").size(), 5 * 6u);
  EXPECT_EQ(json.at("systems").size(), 6u);
  EXPECT_NE(test::read_text(out + "/report.html").find("Pairs removed (table IV)"), std::string::npos);
  EXPECT_NE(outcome.out.find("Where the time goes"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.err.find("study may take long and keeps nothing until it is done"), std::string::npos)
      << outcome.err;
}

TEST_F(AnalysesCommand, DropsNeedPhotosOfTheirViews) {
  std::filesystem::create_directory(folder / "photos");
  const test::Outcome outcome = test::run_program({"study", model, "--photos", folder / "photos", "-o", out});
  EXPECT_TRUE(test::ended(outcome, 2, "there is no photo of any view"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(Study, WhatMakesNoSenseIsNamed) {
  const test::TempFolder folder;
  test::write_text(folder / "file", "");
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong = {
      {{"--json", folder / "s.json"}, "--json goes with --stability"},
      {{"--th", "squared", "--transmittance", "last"}, "--th, --transmittance go with --stability"},
      {{"--target", "45"}, "--target goes with --stability"},
      {{"--stability", "--path", "x.json"}, "are studies of their own"},
      {{"--stability", "--photos", folder / "."}, "--test and --photos are for the analyses"},
      {{"--test", "no-such"}, "--view no-such"},
      {{"-o", folder / "file"}, "file"},
      {{"--rules", "-o", folder / "out"},
       "-o is for the analyses, --stability, --motion, --turn and --levels"},
      {{"--stability", "--case", "no-such"}, "far-wall"},
      {{"--stability", "--view", "no-such"}, "--view no-such"},
      {{"--rules", "--view", "all"}, "--view all"},
      {{"--rules", "--stability"}, "are studies of their own"},
      {{"--turn", "--rules"}, "are studies of their own"},
      {{"--turn", "--frames", "5"}, "--rules"},
      {{"--rules", "--rays", "8x6"}, "--rays goes with --turn"},
      {{"--rays", "8x6"}, "--rays goes with"},
      {{"--turn", "--rays", "8"}, "--rays 8: expected"},
      {{"--turn", "--rays", "20000x20000"}, "at most a million"},
      {{"--rules", "--view", "no-such"}, "--view no-such"},
      {{"--rules", "--th", "squared"}, "--rules"},
      {{"--rules", "--tolerance", "0.1"}, "--tolerance"},
      {{"--rules", "--loss", "0.1"}, "--tolerance"},
      {{"--stability", "--frames", "5"}, "--rules"},
      {{"--path", "no_such.json"}, "no_such.json"},
      {{"--stability", "--json", folder / "file/s.json"}, "file"},
  };
  for (const auto& [options, message] : wrong) {
    std::vector<std::string> all = {"study", "demo:room", "--size", "64x36"};
    all.insert(all.end(), options.begin(), options.end());
    const test::Outcome outcome = test::run_program(all);
    EXPECT_EQ(outcome.code, 2) << message;
    EXPECT_NE(outcome.err.find(message), std::string::npos) << outcome.err;
  }
}

}  // namespace
}  // namespace binosplat
