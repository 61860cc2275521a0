// render --path: through keys, along frames, and what is refused.

#include <glm/glm.hpp>

#include "app/scene.h"

namespace binosplat {
namespace {

using test::ended;
using test::good;
using test::Outcome;
using test::write_text;

using Arguments = std::vector<std::string>;

struct KeysPath : test::SceneTest {
  const std::string path = folder / "path.json";

  /// Four cameras along x that slow down, the last with half the field of view; `step` is the time from each
  /// to the next.
  void save_cameras(double step) const {
    nlohmann::json cameras;
    for (int k = 0; k < 4; ++k) {
      cameras.push_back(test::camera_json("key_" + std::to_string(k), 0.9 * std::sqrt(k / 3.0)));
      cameras.back()["time"] = step * k;
    }
    cameras.back()["fx"] = cameras.back()["fy"] = 120.0;
    write_text(path, cameras.dump());
  }

  Outcome along(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(),
                     {"--path", path, "--mono", "--size", "24x16", "--json", folder / "r.json"});
    if (std::find(arguments.begin(), arguments.end(), "-o") == arguments.end())
      arguments.insert(arguments.end(), {"-o", out});
    return render(arguments);
  }

  nlohmann::json views() const {
    return nlohmann::json::parse(test::read_text(folder / "r.json")).at("views");
  }

  std::vector<double> places() const {
    std::vector<double> out_places;
    for (const auto& view : views()) out_places.push_back(view.at("eyes").at(0).at("position").at(0));
    return out_places;
  }
};

TEST_F(KeysPath, GoesThroughKeys) {
  save_cameras(0.5);
  const Outcome outcome = along({"--fps", "8"});
  EXPECT_TRUE(ended(outcome, 0, "smoothly through the 4 keys of " + path + " in 1.5 s, by their times"));
  const std::vector<double> x = places();
  ASSERT_EQ(x.size(), 13u);
  EXPECT_TRUE(std::filesystem::exists(out + "/path_00012.png"));
  for (const std::size_t k : {0, 1, 2, 3})
    EXPECT_NEAR(x[4 * k], 0.9 * std::sqrt(static_cast<double>(k) / 3.0), 1e-6);
  EXPECT_GT(x[1] - x[0], 2.0 * (x[12] - x[11])) << "by the times, and not at an even pace";
  EXPECT_NE(test::read_text(out + "/path_00011.png"), test::read_text(out + "/path_00012.png"));
}

TEST_F(KeysPath, ManyFramesAreToldInAFewLines) {
  save_cameras(0.5);
  const auto lines = [&](const char* fps) {
    const Outcome outcome = along({"--fps", fps, "--quality", "40"});
    EXPECT_TRUE(good(outcome));
    EXPECT_EQ(outcome.out.find("13 frames: ") != std::string::npos, std::string(fps) == "8") << outcome.out;
    EXPECT_EQ(outcome.out.find("path_00001.png") != std::string::npos, std::string(fps) != "8")
        << outcome.out;
    return std::count(outcome.out.begin(), outcome.out.end(), '\n');
  };
  const auto few = lines("4"), many = lines("8");
  EXPECT_EQ(views().size(), 13u) << "each by itself";
  const auto json = nlohmann::json::parse(test::read_text(folder / "r.json"));
  const bool by_cpu = json["device"]["renderer"].get<std::string>().starts_with("llvmpipe");
  EXPECT_TRUE(!by_cpu || json.contains("exact_frame_ms")) << "whether --quality pays is not known";
  EXPECT_TRUE(ended(render({"--quality", "40", "--mono", "--size", "24x16", "-o", out}), 0,
                    "by itself an exact one is faster"));
  EXPECT_LT(many, few);
}

TEST_F(KeysPath, InSecondsIsAtAnEvenPace) {
  save_cameras(0.5);
  EXPECT_TRUE(ended(along({"--fps", "8", "--seconds", "1"}), 0, "in 1 s: 9 frames"));
  const std::vector<double> x = places();
  ASSERT_EQ(x.size(), 9u);
  EXPECT_NEAR(x[8], 0.9, 1e-6);
  EXPECT_LT(x[1] - x[0], 2.0 * (x[8] - x[7]));
  save_cameras(0.0);  // as files without times
  EXPECT_TRUE(ended(along({"--seconds", "0.1"}), 0, "4 frames, 30 a second"));
}

TEST_F(KeysPath, PicturesOfKeysWhereTheyAreAskedFor) {
  save_cameras(0.5);
  EXPECT_TRUE(good(along({"--keys"})));
  EXPECT_EQ(places().size(), 4u);
  EXPECT_TRUE(std::filesystem::exists(out + "/key_3.png"));
}

TEST_F(KeysPath, FramesAreFrames) {
  const std::string said = "4 frames of " + path + " as they are (not all have times that rise";
  for (const double step : {0.0, 0.04, -0.5}) {
    save_cameras(step);
    const Outcome outcome = along({});
    EXPECT_TRUE(good(outcome));
    EXPECT_EQ(places().size(), 4u) << step;
    EXPECT_EQ(outcome.err.find(said) != std::string::npos, step <= 0.0) << outcome.err;
  }
}

TEST_F(KeysPath, APairOfEyesIsOneKey) {
  nlohmann::json cameras;
  for (int k = 0; k < 3; ++k) {
    for (const int side : {1, -1}) {  // the right eye first
      const std::string name = fmt::format("head{}_{}", k, side < 0 ? "left" : "right");
      cameras.push_back(test::camera_json(name, 0.3 * k + 0.03 * side));
      cameras.back()["time"] = 0.5 * k;
    }
  }
  write_text(path, cameras.dump());
  for (const Arguments& more : {Arguments{"--fps", "4"}, {"--fps", "4", "--seconds", "1"}}) {
    EXPECT_TRUE(ended(along(more), 0, "through the 3 keys of " + path + " in 1 s"));
    const std::vector<double> x = places();
    ASSERT_EQ(x.size(), 5u);
    for (std::size_t n = 0; n < x.size(); ++n)
      EXPECT_NEAR(x[n], 0.15 * static_cast<double>(n), 1e-6) << "not to one eye and the other";
  }
}

TEST_F(KeysPath, AVideoHasTheFrames) {
  if (!have_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  save_cameras(0.5);
  const std::string video = folder / "a.mkv";
  ASSERT_TRUE(good(along({"-o", video})));
  const std::string facts = facts_of(video);
  EXPECT_NE(facts.find("r_frame_rate=30/1"), std::string::npos) << facts;
  EXPECT_NE(facts.find("nb_read_frames=46"), std::string::npos) << facts;
}

TEST_F(KeysPath, WhatCannotHaveAnEffectIsRefused) {
  save_cameras(0.04);
  EXPECT_TRUE(ended(along({"--fps", "30"}), 2, "has frames, each drawn as it is"));
  EXPECT_TRUE(ended(along({"--keys", "--fps", "10"}), 2, "leave one of them out"));
  EXPECT_TRUE(ended(along({"--keys", "--seconds", "2"}), 2, "leave --seconds out"));
  EXPECT_TRUE(ended(render({"--keys", "-o", out}), 2, "name that"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace binosplat
