// render --path: through keys, and along frames.

#include <glm/glm.hpp>

#include "app/scene.h"

namespace binosplat {
namespace {

struct PathOption : SceneTest {
  const std::string path = folder / "path.json";

  /// Writes four cameras along x that slow down, the last one with half the field of view. `step` is the time
  /// between them.
  void save_cameras(double step) const {
    json cameras;
    for (int k = 0; k < 4; ++k) {
      cameras.push_back(camera_json("key_" + std::to_string(k), 0.9 * std::sqrt(k / 3.0)));
      cameras.back()["time"] = step * k;
    }
    cameras.back()["fx"] = cameras.back()["fy"] = 120.0;
    save("path.json", cameras);
  }

  Outcome along(const Words& words) const {
    return render(joined(words, {"--path", path, "--mono", "--size", "24x16", "--json", folder / "r.json"}));
  }

  /// Returns the frames' positions along x.
  std::vector<double> places() const {
    const json report = load_json(folder / "r.json");
    std::vector<double> all;
    for (const json& view : report.at("views")) all.push_back(view.at("eyes").at(0).at("position").at(0));
    return all;
  }
};

TEST_F(PathOption, InterpolatesKeys) {
  save_cameras(0.5);
  EXPECT_TRUE(ended(along({"--fps", "8"}), 0,
                    "smoothly through the 4 keys of " + path + " in 1.5 s, by their times"));
  std::vector<double> x = places();
  ASSERT_EQ(x.size(), 13u);
  EXPECT_TRUE(fs::exists(out + "/path_00012.png"));
  for (const std::size_t k : {0, 1, 2, 3})
    EXPECT_NEAR(x[4 * k], 0.9 * std::sqrt(static_cast<double>(k) / 3.0), 1e-6);
  EXPECT_GT(x[1] - x[0], 2.0 * (x[12] - x[11])) << "by the times, and not at an even pace";
  EXPECT_NE(read_text(out + "/path_00011.png"), read_text(out + "/path_00012.png"));

  EXPECT_TRUE(ended(along({"--fps", "8", "--seconds", "1"}), 0, "in 1 s: 9 frames"));
  x = places();
  ASSERT_EQ(x.size(), 9u);
  EXPECT_NEAR(x[8], 0.9, 1e-6);
  EXPECT_LT(x[1] - x[0], 2.0 * (x[8] - x[7])) << "at an even pace";
  save_cameras(0.0);  // like files without times
  EXPECT_TRUE(ended(along({"--seconds", "0.1"}), 0, "4 frames, 30 a second"));
}

TEST_F(PathOption, SummarizesManyFrames) {
  save_cameras(0.5);
  const auto lines = [&](const char* fps, bool many) {
    const Outcome outcome = checked(along({"--fps", fps, "--quality", "40"}));
    EXPECT_EQ(outcome.out.find("13 frames: ") != std::string::npos, many) << outcome.out;
    EXPECT_EQ(outcome.out.find("path_00001.png") == std::string::npos, many) << outcome.out;
    return std::count(outcome.out.begin(), outcome.out.end(), '\n');
  };
  const auto few = lines("4", false);
  EXPECT_LT(lines("8", true), few);
  EXPECT_EQ(places().size(), 13u) << "each by itself";
  EXPECT_TRUE(ended(render({"--quality", "40", "--mono", "--size", "24x16"}), 0,
                    "--quality 40 drew exact pictures only (small)"));
}

TEST_F(PathOption, FramesAreNotInterpolated) {
  const std::string said = "4 frames of " + path + " as they are (not all have times that rise";
  for (const double step : {0.0, 0.04, -0.5}) {
    save_cameras(step);
    const Outcome outcome = checked(along({}));
    EXPECT_EQ(places().size(), 4u) << step;
    EXPECT_EQ(outcome.err.find(said) != std::string::npos, step <= 0.0) << outcome.err;
  }
  save_cameras(0.5);
  EXPECT_TRUE(good(along({"--keys"})));
  EXPECT_EQ(places().size(), 4u);
  EXPECT_TRUE(fs::exists(out + "/key_3.png"));
}

TEST_F(PathOption, EyePairIsOneKey) {
  json cameras;
  for (int k = 0; k < 3; ++k) {
    for (const int side : {1, -1}) {  // the right eye first
      const std::string name = fmt::format("head{}_{}", k, side < 0 ? "left" : "right");
      cameras.push_back(camera_json(name, 0.3 * k + 0.03 * side));
      cameras.back()["time"] = 0.5 * k;
    }
  }
  save("path.json", cameras);
  for (const Words& more : {Words{"--fps", "4"}, {"--fps", "4", "--seconds", "1"}}) {
    EXPECT_TRUE(ended(along(more), 0, "through the 3 keys of " + path + " in 1 s"));
    const std::vector<double> x = places();
    ASSERT_EQ(x.size(), 5u);
    for (std::size_t n = 0; n < x.size(); ++n)
      EXPECT_NEAR(x[n], 0.15 * static_cast<double>(n), 1e-6) << "not to one eye and the other";
  }
}

}  // namespace
}  // namespace binosplat
