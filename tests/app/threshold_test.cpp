// binosplat render: thresholds, what they go by, and paths.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "app/scene.h"
#include "support/program.h"

namespace binosplat {
namespace {

const std::vector<std::string> room = {"render", "demo:room", "--size", "64x36"};

std::vector<std::string> with(std::vector<std::string> more) {
  std::vector<std::string> all = room;
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

nlohmann::json pairs_of(const test::TempFolder& folder, std::vector<std::string> more) {
  more.insert(more.end(), {"-o", folder / "out", "--json", folder / "run.json"});
  const test::Outcome outcome = test::run_program(with(more));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  return nlohmann::json::parse(test::read_text(folder / "run.json"));
}

TEST(Threshold, AToleranceMakesFewerPairs) {
  const test::TempFolder folder;
  const auto exact = pairs_of(folder, {});
  const auto lossy = pairs_of(folder, {"--tolerance", "0.1"});
  const auto paper = pairs_of(folder, {"--th", "peripheral", "--tolerance", "2"});
  EXPECT_EQ(exact.at("settings").at("th"), "tau");
  EXPECT_EQ(lossy.at("settings").at("th"), "squared");
  EXPECT_LT(lossy.at("views")[0].at("pairs"), exact.at("views")[0].at("pairs"));
  EXPECT_LT(paper.at("views")[0].at("pairs"), exact.at("views")[0].at("pairs"));
  EXPECT_EQ(pairs_of(folder, {"--loss", "0.1"}).at("settings"), lossy.at("settings")) << "its former name";
  const auto repeated = pairs_of(folder, {"--tolerance", "0.1", "--transmittance", "last", "--frames", "3"});
  EXPECT_LT(repeated.at("views")[0].at("pairs"), lossy.at("views")[0].at("pairs"));
}

TEST(Threshold, OptionsThatCannotHaveAnEffectAreRefused) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong = {
      {{"--th", "squared"}, "needs --tolerance, --quality or --calibration"},
      {{"--th", "tau", "--quality", "40"}, "--quality has no effect"},
      {{"--tolerance", "1", "--quality", "40"}, "--tolerance with --quality"},
      {{"--quality", "-3"}, "--quality"},
      {{"--quality", "40", "--reference-until", "project"}, "--reference-until"},
      {{"--th", "tau", "--tolerance", "1"}, "--tolerance has no effect"},
      {{"--tolerance", "-1"}, "--tolerance"},
      {{"--transmittance", "last"}, "--transmittance has no effect with --th tau"},
      {{"--tolerance", "1", "--transmittance", "last", "--reference-until", "project"}, "--reference-until"},
      {{"--path", "x.json", "--frames", "3"}, "--path names its own cameras"},
  };
  for (const auto& [options, message] : wrong) {
    const test::Outcome outcome = test::run_program(with(options));
    EXPECT_EQ(outcome.code, 2) << message;
    EXPECT_NE(outcome.err.find(message), std::string::npos) << outcome.err;
  }
}

TEST(Threshold, AQualityIsComeToWithoutATolerance) {
  const test::TempFolder folder;
  const auto draw = [&](const std::string& name, std::vector<std::string> more) {
    // Not smaller: where dozens of Gaussians share a pixel the error is a step of the tolerance.
    std::vector<std::string> all = {"render", "demo:room",   "--mono", "--size",           "192x108",
                                    "-o",     folder / name, "--json", folder / "run.json"};
    all.insert(all.end(), more.begin(), more.end());
    const test::Outcome outcome = test::run_program(all);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return nlohmann::json::parse(test::read_text(folder / "run.json"));
  };
  draw("exact.png", {});
  const auto run = draw("near.png", {"--quality", "36"});
  EXPECT_EQ(run.at("settings").at("th"), "squared");
  EXPECT_EQ(run.at("settings").at("transmittance"), "one");
  EXPECT_GT(run.at("views")[0].at("tolerance").get<double>(), 0.0);
  const test::Outcome compared = test::run_program(
      {"compare", folder / "near.png", folder / "exact.png", "--json", folder / "compared.json"});
  ASSERT_EQ(compared.code, 0) << compared.err;
  const auto psnr = nlohmann::json::parse(test::read_text(folder / "compared.json")).at("psnr_db");
  EXPECT_NEAR(psnr.get<double>(), 36.0, 1.0);
}

TEST(Threshold, DepthsHaveATable) {
  const test::TempFolder folder;
  const auto pairs = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--tolerance", "0.1"});
    return pairs_of(folder, more).at("views")[0].at("pairs").get<double>();
  };
  EXPECT_LE(pairs({"--transmittance", "depth"}), pairs({}));
}

TEST(Path, DrawsEveryFrameByWhatTheLastOneMeasured) {
  const test::TempFolder folder;
  std::string frames;
  for (int n = 0; n < 3; ++n) {
    if (n > 0) frames += ",";
    frames += fmt::format(R"({{"img_name": "frame_{0}", "width": 64, "height": 36, "fx": 50, "fy": 50,
      "position": [{1}, -1.5, -1], "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "time": {1}}})",
                          n, 0.011 * n);
  }
  test::write_text(folder / "path.json", "[" + frames + "]");
  const test::Outcome outcome =
      test::run_program({"render", "demo:room", "--path", folder / "path.json", "--tolerance", "0.1",
                         "--transmittance", "last", "-o", folder / "out", "--json", folder / "run.json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto run = nlohmann::json::parse(test::read_text(folder / "run.json"));
  ASSERT_EQ(run.at("views").size(), 3u);
  EXPECT_LT(run.at("views")[1].at("pairs").get<double>(),
            0.97 * run.at("views")[0].at("pairs").get<double>());
  EXPECT_TRUE(std::filesystem::exists(folder / "out/frame_2_right.png"));
}

}  // namespace
}  // namespace binosplat
