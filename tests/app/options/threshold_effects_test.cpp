// binosplat render: thresholds, and their sources of transmittance.

#include "app/scene.h"

namespace binosplat {
namespace {

struct ThresholdOptions : SceneTest {
  json drawn(const std::string& scene, const Words& words) const {
    EXPECT_TRUE(good(run_into_out(joined({"render", scene, "--json", folder / "r.json"}, words))));
    return load_json(folder / "r.json");
  }
  json room(const Words& words) const { return drawn("demo:room", words); }
  /// Draws the smallest city.
  json city(const Words& words) const {
    return drawn("demo:city", joined(words, {"--count", "10000", "--size", "64x36"}));
  }
};

double pairs_of(const json& run, std::size_t view = 0) { return run["views"][view]["pairs"]; }

TEST_F(ThresholdOptions, ToleranceRemovesPairs) {
  const json exact = city({}), lossy = city({"--threshold", "squared", "--tolerance", "0.1"});
  EXPECT_EQ(exact["settings"]["threshold"], "exact");
  EXPECT_EQ(lossy["settings"]["threshold"], "squared");
  EXPECT_LT(pairs_of(lossy), pairs_of(exact));
  const json alone = city({"--tolerance", "2"});
  EXPECT_EQ(alone["settings"]["threshold"], "adagscale") << "squared darkens scenes that nobody measured";
  EXPECT_LT(pairs_of(alone), pairs_of(exact));
  const Words last = {"--threshold",     "squared", "--tolerance", "0.1",
                      "--transmittance", "last",    "--frames",    "3"};
  EXPECT_LT(pairs_of(city(last)), pairs_of(lossy));
  EXPECT_LE(pairs_of(city({"--threshold", "squared", "--tolerance", "0.1", "--transmittance", "depth"})),
            pairs_of(lossy));
}

TEST_F(ThresholdOptions, QualityFindsTolerance) {
  const auto draw = [&](const std::string& name, const Words& words) {
    // In smaller pictures dozens of Gaussians share a pixel, and the error is a step function of the
    // tolerance.
    return room(joined(words, {"--mono", "--size", "960x640", "-o", folder / name}));
  };
  draw("exact.png", {});
  const json run = draw("near.png", {"--quality", "36", "--frames", "16"});
  EXPECT_EQ(run["settings"]["threshold"], "either");
  EXPECT_EQ(run["views"][0]["threshold"], "squared") << "lists are short";
  EXPECT_EQ(run["settings"]["transmittance"], "one");
  EXPECT_GT(run["views"][0]["tolerance"].get<double>(), 0.0);
  EXPECT_NEAR(psnr_of_files(folder / "near.png", folder / "exact.png"), 36.0, 1.0);
}

TEST_F(ThresholdOptions, PathUsesPreviousMeasurement) {
  json frames;
  for (int n = 0; n < 3; ++n) {
    frames.push_back(camera_json("frame_" + std::to_string(n), 0.011 * n));
    frames[n].update({{"width", 64}, {"height", 36}, {"fx", 50}, {"fy", 50}, {"time", 0.011 * n}});
    frames[n]["position"] = {0.011 * n, -1.5, -1};
  }
  const json run = room({"--path", save("path.json", frames), "--threshold", "squared", "--tolerance", "0.1",
                         "--transmittance", "last"});
  ASSERT_EQ(run["views"].size(), 3u);
  EXPECT_LT(pairs_of(run, 1), 0.97 * pairs_of(run));
  EXPECT_TRUE(fs::exists(out + "/frame_2_right.png"));
}

}  // namespace
}  // namespace binosplat
