// render --tour: the head's path, as files and as a video.

#include <glm/glm.hpp>

#include "app/scene.h"

namespace binosplat {
namespace {

struct TourOption : SceneTest {
  /// Writes five cameras 0.25 apart along x, and one at the end that is rotated by 45 degrees.
  TourOption() {
    json cameras;
    for (int k = 0; k < 5; ++k) cameras.push_back(camera_json(fmt::format("v{}", k), 0.25 * k));
    const double s = std::sqrt(0.5);
    cameras.push_back(camera_json("turned", 1.0));
    cameras.back()["rotation"] = {{s, 0, s}, {0, 1, 0}, {-s, 0, s}};
    save("cameras.json", cameras);
  }

  Outcome tour(const Words& words) const {
    Outcome outcome = render(joined(words, {"--size", "32x24", "--json", folder / "run.json"}));
    EXPECT_TRUE(good(outcome));
    return outcome;
  }

  json views() const { return load_json(folder / "run.json").at("views"); }
};

glm::dvec3 place(const json& view, std::size_t eye = 0) {
  const auto p = view.at("eyes").at(eye).at("position").get<std::vector<double>>();
  return {p.at(0), p.at(1), p.at(2)};
}

TEST_F(TourOption, SpeedUsesPictureMetres) {
  const Outcome outcome = tour({"--tour", "walk", "--seconds", "0.05", "--mono"});
  EXPECT_TRUE(has(outcome.err, "a metre is one world unit."));
  EXPECT_TRUE(has(outcome.err, "--units-per-metre 0.25 makes that a metre"));
  EXPECT_TRUE(
      has(outcome.err, fmt::format("through 6 cameras of {}/cameras.json at", folder.path().string())));
  EXPECT_TRUE(has(outcome.err, "5 frames, 0.0556 s"));
  const json frames = views();
  ASSERT_EQ(frames.size(), 5u);
  for (std::size_t k = 1; k < frames.size(); ++k)
    EXPECT_NEAR(glm::distance(place(frames[k]), place(frames[k - 1])), 0.51 / 90.0, 1e-3);
  EXPECT_EQ(frames[4].at("name"), "tour_00004");
  ASSERT_TRUE(good(render({"--view", "v0", "--mono", "--size", "32x24", "-o", folder / "v0.png"})));
  const auto pixels = [](const std::string& file) { return load_image(file).data; };
  EXPECT_EQ(pixels(out + "/tour_00000.png"), pixels(folder / "v0.png")) << "it begins at the first camera";
  EXPECT_NE(pixels(out + "/tour_00004.png"), pixels(folder / "v0.png"));
}

TEST_F(TourOption, EyesAndSpeedShareMetre) {
  const auto expect = [&](const Words& metre, double units, const std::string& said) {
    const Outcome outcome = tour(joined(metre, {"--tour", "3,90", "--fps", "50", "--seconds", "0.04"}));
    EXPECT_TRUE(has(outcome.err, said));
    const json frames = views();
    ASSERT_EQ(frames.size(), 2u);
    EXPECT_NEAR(glm::distance(place(frames[0]), place(frames[1])), units * 3.0 / 50.0, 1e-4);
    EXPECT_NEAR(glm::distance(place(frames[0], 0), place(frames[0], 1)), units * 0.063, 1e-6);
    EXPECT_EQ(frames[0].at("units_per_metre"), units);
    // Single pictures use the same metre.
    EXPECT_EQ(reported(joined(metre, {"--view", "v0", "--size", "32x24"}))["views"][0]["units_per_metre"],
              units);
  };
  expect({"--units-per-metre", "0.5"}, 0.5, "at up to 3 m and 90 degrees a second");
  save_pose(0.75, 0.063);
  expect({}, 0.75, "0.75 world units per metre");
}

TEST_F(TourOption, BuiltInScenesUseMetres) {
  const Outcome outcome =
      checked(run_program({"render", "demo:room", "--tour", "calm", "--seconds", "0.02", "--size", "32x24",
                           "--mono", "--json", folder / "run.json", "-o", out}));
  EXPECT_FALSE(has(outcome.err, "a metre is"));
  const json frames = views();
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_LT(glm::distance(place(frames[0]), place(frames[1])), 1.01 * 0.23 / 90.0);
  EXPECT_EQ(frames[0].at("units_per_metre"), 1.0);
}

TEST_F(TourOption, VideoHasAllFrames) {
  if (!have_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  const auto expect = [&](const Words& words, const char* rate, const char* count) {
    const std::string video = folder / "a.mkv";
    tour(joined(words, {"--tour", "walk", "--seconds", "0.25", "--units-per-metre", "0.25", "-o", video}));
    const std::string facts = facts_of(video);
    EXPECT_TRUE(has(facts, rate));
    EXPECT_TRUE(has(facts, count));
  };
  expect({}, "r_frame_rate=30/1", "nb_read_frames=8");
  expect({"--fps", "12"}, "r_frame_rate=12/1", "nb_read_frames=3");
}

}  // namespace
}  // namespace binosplat
