// binosplat study --motion, as a user runs it.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/scene.h"
#include "support/program.h"

namespace binosplat {
namespace {

struct MotionCommand : test::SceneTest {
  MotionCommand() { add_cameras(); }

  std::string printed;

  nlohmann::json motion(std::vector<std::string> more) {
    more.insert(more.begin(),
                {"study", model, "--motion", "--lead", "2", "--rounds", "1", "--json", folder / "m.json"});
    const test::Outcome outcome = test::run_program(more);
    EXPECT_TRUE(test::good(outcome));
    printed = outcome.out;
    return nlohmann::json::parse(test::read_text(folder / "m.json"));
  }

  std::string page() const { return test::read_text(out + "/report.html"); }
};

TEST_F(MotionCommand, GoesThroughTheCamerasAndLeavesAPage) {
  const auto json =
      motion({"--motions", "still,walk", "--frames", "3", "--segments", "2", "--stop", "1", "--rule",
              "squared,one", "--rule", "peripheral,last", "--size", "36x24", "--target", "38", "-o", out});
  EXPECT_EQ(json.at("eyes"), 2);
  EXPECT_EQ(json.at("width"), 36);
  EXPECT_EQ(json.at("metre_source"), "nothing says otherwise");
  EXPECT_EQ(json.at("units_per_metre"), 1.0) << "as render has it";
  ASSERT_EQ(json.at("paths").size(), 2u);
  const auto& still = json.at("paths")[0];
  EXPECT_EQ(still.at("name"), "still");
  EXPECT_EQ(still.at("lengths")[1], nlohmann::json({{"lead", 2}, {"moving", 3}, {"stop", 0}}));
  const auto& walk = json.at("paths")[1];
  EXPECT_EQ(walk.at("motion"), "1.5 m/s, 45 degrees a second");
  ASSERT_EQ(walk.at("lengths").size(), 2u);
  EXPECT_EQ(walk.at("lengths")[0], nlohmann::json({{"lead", 2}, {"moving", 3}, {"stop", 1}}));
  ASSERT_EQ(walk.at("rules").size(), 2u);
  EXPECT_EQ(walk.at("rules")[1].at("name"), "peripheral, last");
  EXPECT_EQ(walk.at("rules")[0].at("asked").at("segments")[1].at("true_db").size(), 6u);
  const auto& at_target = walk.at("rules")[0].at("at_target");
  const bool near = std::abs(at_target.at("moving").at("true_db").get<double>() - 38.0) <= 0.1;
  EXPECT_EQ(near, at_target.at("problem").get<std::string>().empty());
  EXPECT_NE(printed.find("\n## walk\n"), std::string::npos) << printed;
  EXPECT_NE(page().find("Whether rules keep their word"), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(test::read_text(out + "/study.json")), json);
}

TEST_F(MotionCommand, GoesAlongAFileWithEveryRuleThatOneEyeCanGoBy) {
  nlohmann::json path;
  for (int n = 0; n < 4; ++n) path.push_back(test::camera_json(fmt::format("frame_{}", n), 0.01 * n));
  test::write_text(folder / "way.json", path.dump());
  const auto json = motion({"--path", folder / "way.json", "--mono", "--size", "24x16", "--no-equal",
                            "--stop", "0", "--units-per-metre", "2"});
  EXPECT_EQ(json.at("eyes"), 1);
  EXPECT_EQ(json.at("units_per_metre"), 2.0);
  EXPECT_EQ(json.at("metre_source"), "--units-per-metre");
  ASSERT_EQ(json.at("paths").size(), 1u);
  EXPECT_EQ(json.at("paths")[0].at("name"), "way");
  EXPECT_EQ(json.at("paths")[0].at("lengths")[0], nlohmann::json({{"lead", 2}, {"moving", 2}, {"stop", 0}}));
  const auto& rules = json.at("paths")[0].at("rules");
  EXPECT_GE(rules.size(), 2u);
  for (const auto& rule : rules) {
    EXPECT_NE(rule.at("name"), "tau") << "always measured, and no rule";
    EXPECT_FALSE(rule.contains("at_target"));
    EXPECT_NE(printed.find("\n| " + rule.at("name").get<std::string>() + " | "), std::string::npos)
        << printed;
  }
}

TEST_F(MotionCommand, GoesThroughKeys) {
  nlohmann::json path;
  for (int n = 0; n < 3; ++n) {
    path.push_back(test::camera_json(fmt::format("key_{}", n), 0.1 * n));
    path.back()["time"] = 0.2 * n;
  }
  test::write_text(folder / "way.json", path.dump());
  const auto json = motion({"--path", folder / "way.json", "--mono", "--size", "24x16", "--no-equal",
                            "--stop", "0", "--rule", "squared,one"});
  EXPECT_EQ(json.at("paths")[0].at("lengths")[0], nlohmann::json({{"lead", 2}, {"moving", 35}, {"stop", 0}}));
}

TEST_F(MotionCommand, WhatMakesNoSenseIsNamed) {
  nlohmann::json alone = {test::camera_json("alone", 0.0)};
  test::write_text(folder / "alone.json", alone.dump());
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong = {
      {{"--motion", "--view", "front"}, "--view goes with the analyses or --turn or --levels"},
      {{"--motion", "--motions", "crawl"}, "crawl"},
      {{"--motion", "--rule", "squared"}, "expected TH,SOURCE"},
      {{"--motion", "--rule", "squared,first"}, "'first' is not one of one"},
      {{"--motion", "--rule", "tau,one"}, "is exact, and always measured"},
      {{"--motion", "--rule", "squared,last,off"}, "expected TH,SOURCE"},
      {{"--motion", "--cameras", folder / "alone.json"}, "two cameras or more"},
      {{"--motion", "--path", folder / "alone.json"}, "two cameras or more"},
      {{"--motion", "--photos", folder / "."}, "--photos goes with the analyses or --turn"},
      {{"--motion", "--path", folder / "alone.json", "--motions", "walk"}, "are for tours"},
      {{"--motion", "--no-equal", "--target", "38"}, "--no-equal"},
      {{"--segments", "2"}, "--motion"},
      {{"--turn", "--rule", "squared,one"}, "--motion"},
      {{"--no-equal"}, "--motion"},
  };
  for (const auto& [options, message] : wrong) {
    std::vector<std::string> all = {"study", model, "--size", "36x24"};
    all.insert(all.end(), options.begin(), options.end());
    EXPECT_TRUE(test::ended(test::run_program(all), 2, message));
  }
  EXPECT_TRUE(test::ended(test::run_program({"study", model, "--motion", "-o", model}), 2, "model.ply"));
  std::filesystem::remove(folder / "cameras.json");
  EXPECT_TRUE(test::ended(test::run_program({"study", model, "--motion"}), 2, "--cameras"));
}

}  // namespace
}  // namespace binosplat
