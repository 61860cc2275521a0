// binosplat study, as a user runs it.

#include <gtest/gtest.h>

#include <algorithm>
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
  const test::Outcome outcome = test::run_program(
      {"study", "demo:room", "--path", folder / "path.json", "--loss", "0.05", "--json", folder / "s.json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("fell back: equals `one`"), std::string::npos) << outcome.out;
  const auto json = nlohmann::json::parse(test::read_text(folder / "s.json"));
  ASSERT_EQ(json.at("frames").size(), 3u);
  EXPECT_EQ(json.at("variant"), "squared, last, off, per-eye");
  EXPECT_GT(json.at("frames")[2].at("removed").get<double>(), 0.0);
}

// What frames of a file of the same 1000 Gaussians come to.
nlohmann::json carried(const test::TempFolder& folder, const std::string& model) {
  const test::Outcome outcome = test::run_program(
      {"study", model, "--path", folder / "path.json", "--loss", "0.05", "--json", folder / "s.json"});
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

using RulesCommand = test::SceneTest;

TEST_F(RulesCommand, PrintsARowForEachRuleOfAPairAndKeepsAll) {
  add_cameras();
  const test::Outcome outcome = test::run_program({"study", model, "--rules", "--view", "pair", "--target",
                                                   "36", "--frames", "1", "--json", folder / "r.json"});
  ASSERT_TRUE(test::good(outcome));
  const auto json = nlohmann::json::parse(test::read_text(folder / "r.json"));
  const std::string renderer = json.at("renderer");
  EXPECT_EQ(outcome.out.rfind(renderer + ": " + model + ", pair, 2 x 72 x 48 px, 36 dB\n", 0), 0u)
      << outcome.out;
  ASSERT_EQ(json.at("rules").size(), 17u);
  for (const auto& rule : json.at("rules")) {
    const std::string name = rule.at("name");
    SCOPED_TRACE(name);
    const auto row = outcome.out.find("\n| " + name + " | ");
    ASSERT_NE(row, std::string::npos) << outcome.out;
    const std::string cells = outcome.out.substr(row + 1, outcome.out.find('\n', row + 1) - row - 1);
    EXPECT_EQ(std::count(cells.begin(), cells.end(), '|'), 18);
    const double ms = rule.at("frame_ms");
    EXPECT_NE(cells.find(fmt::format(" {:.3f} |", ms)), std::string::npos) << cells;
    EXPECT_GT(rule.at("stages_ms").at("blend").get<double>(), 0.0);
    if (name == "tau") {
      EXPECT_TRUE(rule.at("psnr_db").is_null());
      EXPECT_EQ(rule.at("pairs_removed"), 0.0);
    } else if (!rule.contains("problem")) {
      EXPECT_NEAR(rule.at("psnr_db").get<double>(), 36.0, 0.3);
    }
  }
}

TEST_F(RulesCommand, DrawsTheOneViewOrARigOfAPreset) {
  add_cameras();
  // No loss makes a picture of 1 dB: quickly seen, and no reason to end.
  const auto rules_of = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"study", model, "--rules", "--view", "front", "--size", "61x53", "--target",
                               "1", "--frames", "1", "--json", folder / "r.json"});
    EXPECT_TRUE(test::good(test::run_program(more)));
    auto json = nlohmann::json::parse(test::read_text(folder / "r.json"));
    for (std::size_t k = 1; k < json.at("rules").size(); ++k)
      EXPECT_EQ(json.at("rules")[k].at("problem"), "not within 0.3 dB of 1 dB");
    return json;
  };
  const auto mono = rules_of({"--mono"});
  EXPECT_EQ(mono.at("eyes"), 1);
  EXPECT_EQ(mono.at("rules").size(), 9u);
  EXPECT_TRUE(mono.at("rules")[1].at("disagreement_db").is_null());
  const auto wide = rules_of({"--preset", "headset"}), own = rules_of({});
  EXPECT_EQ(wide.at("eyes"), 2);
  EXPECT_EQ(wide.at("width"), 61);
  EXPECT_LT(wide.at("rules")[0].at("pairs").get<double>(), own.at("rules")[0].at("pairs").get<double>());
}

TEST(Study, WhatMakesNoSenseIsNamed) {
  const test::TempFolder folder;
  test::write_text(folder / "file", "");
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong = {
      {{}, "--stability"},
      {{"--stability", "--path", "x.json"}, "choose --stability, --eyes, --rules or --path"},
      {{"--stability", "--case", "no-such"}, "far-wall"},
      {{"--stability", "--view", "no-such"}, "--view no-such"},
      {{"--eyes", "--view", "all"}, "--view all"},
      {{"--eyes", "--mono"}, "compares the eyes"},
      {{"--rules", "--eyes"}, "choose --stability"},
      {{"--rules", "--view", "no-such"}, "--view no-such"},
      {{"--rules", "--th", "squared"}, "--rules"},
      {{"--rules", "--loss", "0.1"}, "--loss"},
      {{"--eyes", "--frames", "5"}, "--rules"},
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
