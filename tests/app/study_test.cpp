// binosplat study, as a user runs it.

#include <gtest/gtest.h>

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

TEST(Study, WhatMakesNoSenseIsNamed) {
  const test::TempFolder folder;
  test::write_text(folder / "file", "");
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong = {
      {{}, "--stability"},
      {{"--stability", "--path", "x.json"}, "choose --stability, --eyes or --path"},
      {{"--stability", "--case", "no-such"}, "far-wall"},
      {{"--stability", "--view", "no-such"}, "--view no-such"},
      {{"--eyes", "--view", "all"}, "--view all"},
      {{"--eyes", "--mono"}, "compares the eyes"},
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
