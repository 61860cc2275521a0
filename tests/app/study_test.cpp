// binosplat study, as a user runs it.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "app/scene.h"
#include "support/fixtures.h"
#include "support/program.h"

namespace binosplat {
namespace {

// The pairs of the exact frames along a path, of a file of the same 1000 Gaussians.
std::vector<double> exact_pairs_along(const std::string& path, const std::string& model,
                                      const std::string& json) {
  EXPECT_TRUE(test::good(
      test::run_program({"study", model, "--motion", "--path", path, "--mono", "--no-equal", "--stop", "0",
                         "--rounds", "1", "--rule", "squared,one", "--json", json})));
  return test::load_json(json).at("paths")[0].at("exact").at("segments")[0].at("pairs");
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
  const auto pairs_in = [&](const std::string& model) {
    return exact_pairs_along(folder / "path.json", fixtures / model, folder / "s.json");
  };
  const auto ply = pairs_in("ply/inria-train-1000.ply"),
             gltf = pairs_in("gltf/st-train-sh3.glb");  // x left, y up
  for (std::size_t n = 0; n < 2; ++n) {
    EXPECT_GT(ply[n], 100.0);
    EXPECT_NEAR(gltf[n], ply[n], 0.01 * ply[n]);
  }
}

struct TurnCommand : test::SceneTest {};

TEST_F(TurnCommand, ATurnedHeadIsMeasuredAgainstPhotosToo) {
  add_cameras();
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

TEST_F(TurnCommand, MetresAreThoseOfTheOption) {
  test::save_ply(model, test::floor_model());
  const test::Outcome outcome =
      test::run_program({"study", model, "--turn", "--rays", "2x2", "--size", "36x24", "--units-per-metre",
                         "0.5", "--json", folder / "s.json"});
  EXPECT_TRUE(test::good(outcome));
  EXPECT_NE(outcome.err.find("from 0.8 units above the ground"), std::string::npos) << outcome.err;
}

struct AnalysesCommand : test::SceneTest {
  AnalysesCommand() { add_cameras(); }
};

TEST_F(AnalysesCommand, LeavesAPageAndItsNumbers) {
  const test::Outcome outcome =
      test::run_program({"study", model, "--view", "front", "--test", "side", "--size", "36x24", "--frames",
                         "1", "--rule", "peripheral,depth", "--rule", "squared,last", "-o", out});
  ASSERT_TRUE(test::good(outcome));
  const auto json = nlohmann::json::parse(test::read_text(out + "/study.json"));
  EXPECT_EQ(json.at("target"), "quality");
  EXPECT_EQ(json.at("width"), 36);
  EXPECT_EQ(json.at("views").at("calibration"), nlohmann::json({"front"}));
  EXPECT_EQ(json.at("views").at("test"), nlohmann::json({"side"}));
  EXPECT_EQ(json.at("found").size(), 5 * 3u);
  EXPECT_EQ(json.at("tuned").size(), 5 * 3u);
  EXPECT_EQ(json.at("systems").size(), 7u);
  EXPECT_NE(test::read_text(out + "/report.html").find("Pairs removed (table IV)"), std::string::npos);
  EXPECT_NE(outcome.out.find("Where the time goes"), std::string::npos) << outcome.out;
}

// Two scenes at once, and the choice of views: cameras as INRIA's trainer lists them, those for tests first.
TEST_F(AnalysesCommand, ScenesShareAPageAndTestsAreHeldOut) {
  nlohmann::json cameras;
  for (const char* name : {"b", "h", "a", "c", "d", "e", "f", "g", "i", "j"})
    cameras.push_back(test::camera_json(name, 0.05 * static_cast<double>(cameras.size())));
  test::write_text(folder / "cameras.json", cameras.dump());
  const std::string other = folder / "other.ply";
  std::filesystem::copy_file(model, other);
  const test::Outcome outcome =
      test::run_program({"study", model, other, "--cameras", folder / "cameras.json", "--size", "18x12",
                         "--frames", "1", "--rule", "peripheral,depth", "-o", out});
  ASSERT_TRUE(test::good(outcome));
  EXPECT_NE(outcome.out.find("| AdaGScale, 40 dB | "), std::string::npos) << outcome.out;
  const auto one = test::load_json(out + "/" + std::filesystem::path(model).stem().string() + "/study.json");
  EXPECT_EQ(one.at("views").at("test"), nlohmann::json({"b", "h"}));
  EXPECT_EQ(one.at("views").at("calibration").size(), 8u);
  EXPECT_EQ(test::load_json(out + "/other/study.json").at("views"), one.at("views"));
  EXPECT_EQ(test::load_json(out + "/study.json").at("means").size(), 6u) << "all but binosplat's own";
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
      {{"--json", folder / "s.json"}, "--json goes with --motion or --turn or --levels"},
      {{"--target", "45"}, "--target goes with --motion"},
      {{"--path", "x.json"}, "--path goes with --motion"},
      {{"--turn", "--test", "front"}, "--test goes with the analyses"},
      {{"--turn", "--far", "5"}, "--far goes with the analyses"},
      {{"--motion", "--hold-out", "4"}, "--hold-out goes with the analyses"},
      {{"--test", "no-such"}, "--view no-such"},
      {{"-o", folder / "file"}, "file"},
      {{"--turn", "--view", "all"}, "--view all"},
      {{"--turn", "--motion"}, "are studies of their own"},
      {{"--turn", "--frames", "5"}, "--frames goes with the analyses or --motion or --levels"},
      {{"--rays", "8x6"}, "--rays goes with --turn"},
      {{"--turn", "--rays", "8"}, "--rays 8: expected"},
      {{"--turn", "--rays", "20000x20000"}, "at most a million"},
      {{"--turn", "--view", "no-such"}, "--view no-such"},
      {{"--turn", "--json", folder / "file/s.json"}, "file"},
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
