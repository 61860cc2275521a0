// render --tour: the head's way from frame to frame as files, as a video, and what is refused.

#include <fmt/format.h>

#include <glm/glm.hpp>

#include "app/scene.h"
#include "formats/image_file.h"

namespace binosplat {
namespace {

using test::ended;
using test::good;
using test::Outcome;
using test::write_text;
using Names = std::set<std::string>;

struct Tour : test::SceneTest {
  /// Five cameras 0.25 apart along x, and one at the end that is turned by 45 degrees.
  Tour() {
    nlohmann::json cameras;
    for (int k = 0; k < 5; ++k) cameras.push_back(test::camera_json(fmt::format("v{}", k), 0.25 * k));
    const double s = std::sqrt(0.5);
    nlohmann::json turned = test::camera_json("turned", 1.0);
    turned["rotation"] = {{s, 0, s}, {0, 1, 0}, {-s, 0, s}};
    cameras.push_back(turned);
    write_text(folder / "cameras.json", cameras.dump());
  }

  Outcome tour(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"--size", "32x24", "--json", folder / "run.json"});
    if (std::find(arguments.begin(), arguments.end(), "-o") == arguments.end())
      arguments.insert(arguments.end(), {"-o", out});
    return render(arguments);
  }

  nlohmann::json views() const {
    return nlohmann::json::parse(test::read_text(folder / "run.json")).at("views");
  }
};

glm::dvec3 place(const nlohmann::json& view, std::size_t eye = 0) {
  const auto p = view.at("eyes").at(eye).at("position").get<std::vector<double>>();
  return {p.at(0), p.at(1), p.at(2)};
}

bool says(const Outcome& outcome, const std::string& text) {
  return outcome.err.find(text) != std::string::npos;
}

TEST_F(Tour, WalksInMetresThatAreThoseOfPictures) {
  const Outcome outcome = tour({"--tour", "walk", "--seconds", "0.05", "--mono"});
  ASSERT_TRUE(good(outcome));
  EXPECT_TRUE(says(outcome, "a metre is one world unit, as for pictures")) << outcome.err;
  EXPECT_TRUE(says(outcome, "--units-per-metre 0.25 takes that for a metre")) << outcome.err;
  EXPECT_TRUE(says(outcome, fmt::format("through 6 cameras of {}/cameras.json at", folder.path().string())))
      << outcome.err;
  EXPECT_TRUE(says(outcome, "5 frames, 0.0556 s")) << outcome.err;
  const auto frames = views();
  ASSERT_EQ(frames.size(), 5u);
  for (std::size_t k = 1; k < frames.size(); ++k)
    EXPECT_NEAR(glm::distance(place(frames[k]), place(frames[k - 1])), 1.5 / 90.0, 1e-6);
  EXPECT_EQ(frames[4].at("name"), "tour_00004");
  EXPECT_TRUE(std::filesystem::exists(out + "/tour_00004.png"));
  ASSERT_TRUE(good(render({"--view", "v0", "--mono", "--size", "32x24", "-o", folder / "v0.png"})));
  const auto pixels = [](const std::string& file) { return load_image(file).data; };
  EXPECT_EQ(pixels(out + "/tour_00000.png"), pixels(folder / "v0.png")) << "it begins at the first camera";
  EXPECT_NE(pixels(out + "/tour_00004.png"), pixels(folder / "v0.png"));
}

TEST_F(Tour, EyesAndSpeedsHaveOneMetre) {
  const auto expect = [&](std::vector<std::string> more, double units, const std::string& said) {
    more.insert(more.end(), {"--tour", "3,90", "--fps", "50", "--seconds", "0.04"});
    const Outcome outcome = tour(more);
    ASSERT_TRUE(good(outcome));
    EXPECT_TRUE(says(outcome, said)) << outcome.err;
    EXPECT_EQ(says(outcome, "a metre is one world unit"), said == "a metre is one world unit") << outcome.err;
    const auto frames = views();
    ASSERT_EQ(frames.size(), 2u);
    EXPECT_NEAR(glm::distance(place(frames[0]), place(frames[1])), units * 3.0 / 50.0, 1e-6);
    EXPECT_NEAR(glm::distance(place(frames[0], 0), place(frames[0], 1)), units * 0.063, 1e-6);
    EXPECT_EQ(frames[0].at("units_per_metre"), units);
    // A picture has the same metre.
    std::vector<std::string> still = {"--view", "v0", "--size", "32x24",
                                      "-o",     out,  "--json", folder / "s.json"};
    if (more[0] == "--units-per-metre") still.insert(still.end(), {more[0], more[1]});
    EXPECT_TRUE(good(render(still)));
    EXPECT_EQ(nlohmann::json::parse(test::read_text(folder / "s.json"))["views"][0]["units_per_metre"],
              units);
  };
  expect({}, 1.0, "a metre is one world unit");
  expect({"--units-per-metre", "0.5"}, 0.5, "at up to 3 m and 90 degrees a second");
  nlohmann::json pose = test::camera_json("saved", 0.5);
  pose.update({{"up", {0, -1, 0}}, {"units_per_metre", 0.75}, {"ipd_metres", 0.063}, {"near", 0.1}});
  write_text(folder / "model.binosplat.json", nlohmann::json::array({pose}).dump());
  expect({}, 0.75, "0.75 world units a metre");
  expect({"--units-per-metre", "0.5"}, 0.5, "at up to 3 m and 90 degrees a second");
}

TEST_F(Tour, ItsFirstToleranceIsSearchedAsThatOfAnyPictureIs) {
  const auto tolerances = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--quality", "40", "--preset", "headset"});
    EXPECT_TRUE(good(tour(more)));
    std::vector<double> found;
    for (const auto& view : views()) found.push_back(view.at("tolerance"));
    return found;
  };
  const std::vector<double> on_tour =
      tolerances({"--tour", "fast", "--seconds", "0.03", "--units-per-metre", "1"});
  ASSERT_EQ(on_tour.size(), 3u);
  EXPECT_TRUE(std::filesystem::exists(out + "/tour_00002_right.png"));
  const std::vector<double> on_path = tolerances({"--path", folder / "cameras.json"});
  EXPECT_EQ(on_tour[0], on_path[0]);
  EXPECT_EQ(on_tour[0], tolerances({"--view", "v0"})[0]);
  EXPECT_NE(on_tour[0], on_path.back()) << "another view's tolerance goes unnoticed";
}

TEST_F(Tour, PairsAreHeads) {
  add_cameras();  // front and pair are at one place, side is half a unit away
  ASSERT_TRUE(good(tour({"--tour", "1,90", "--fps", "4", "--mono", "--units-per-metre", "0.5"})));
  const auto frames = views();
  ASSERT_EQ(frames.size(), 5u);  // 1 m in 1 s
  EXPECT_NEAR(place(frames[0]).x, 0.0, 1e-6);
  EXPECT_NEAR(place(frames[4]).x, 0.5, 1e-6);
}

TEST_F(Tour, ScenesThatAreBuiltInAreInMetres) {
  const Outcome outcome =
      test::run_program({"render", "demo:room", "--tour", "calm", "--seconds", "0.02", "--size", "32x24",
                         "--mono", "--json", folder / "run.json", "-o", out});
  ASSERT_TRUE(good(outcome));
  EXPECT_FALSE(says(outcome, "a metre is")) << outcome.err;
  const auto frames = views();
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_LT(glm::distance(place(frames[0]), place(frames[1])), 1.01 * 0.3 / 90.0);
  EXPECT_EQ(frames[0].at("units_per_metre"), 1.0);
}

TEST_F(Tour, AVideoHasTheToursFrames) {
  if (!have_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  const std::string video = folder / "a.mkv";
  const auto facts = [&](std::vector<std::string> more) {
    more.insert(more.end(),
                {"--tour", "walk", "--seconds", "0.25", "--units-per-metre", "0.25", "-o", video});
    EXPECT_TRUE(good(tour(more)));
    return facts_of(video);
  };
  const std::string usual = facts({}), slow = facts({"--fps", "12"});
  EXPECT_NE(usual.find("r_frame_rate=30/1"), std::string::npos) << usual;
  EXPECT_NE(usual.find("nb_read_frames=8"), std::string::npos) << usual;
  EXPECT_NE(slow.find("r_frame_rate=12/1"), std::string::npos) << slow;
  EXPECT_NE(slow.find("nb_read_frames=3"), std::string::npos) << slow;
  const auto frames = views();
  EXPECT_NEAR(glm::distance(place(frames[0]), place(frames[1])), 0.25 * 1.5 / 12.0, 1e-6);
}

TEST_F(Tour, WhatCannotHaveAnEffectIsRefused) {
  const auto before = folder.files();
  const struct {
    std::vector<std::string> arguments;
    const char* said;
  } cases[] = {
      {{"--tour", "trot"}, "--tour trot: expected calm, walk, fast, or metres and degrees a second"},
      {{"--tour", "1.5"}, "as in 1.5,45"},
      {{"--tour", "1.5,45,3"}, "as in 1.5,45"},
      {{"--tour", "0,45"}, "above 0"},
      {{"--tour", "1,-45"}, "above 0"},
      {{"--tour", "inf,45"}, "above 0"},
      {{"--tour", "walk", "--seconds", "0"}, "above zero"},
      {{"--tour", "walk", "--seconds", "nan"}, "above zero"},
      {{"--tour", "walk", "--fps", "-1"}, "above zero"},
      {{"--seconds", "1"}, "--seconds is for --tour, how much of it is drawn, and for --path"},
      {{"--fps", "30"}, "--fps is for videos, --tour and --path"},
      {{"--tour", "walk", "--view", "v0"}, "--tour goes through all cameras"},
      {{"--tour", "walk", "--path", "p.json"}, "leave --view, --path"},
      {{"--tour", "walk", "--orbit", "3"}, "--orbit"},
      {{"--tour", "walk", "--eye", "0,0,0", "--at", "0,0,1"}, "--tour goes through all cameras"},
      {{"--tour", "walk", "--frames", "2"}, "--frames out"},
      {{"--tour", "walk", "--mono", "--photos", folder.path()}, "--photos with --tour"},
      {{"--tour", "walk", "--up", "0,0,1"}, "--up and --fov are for cameras that are made up"},
      {{"--tour", "1e-9,1e-9"}, "go faster"},
      {{"--tour", "walk", "-o", folder / "a.png"}, "name a folder"},
      {{"--tour", "walk", "--cameras", folder / "no.json"}, "no.json"},
  };
  for (const auto& c : cases) EXPECT_TRUE(ended(tour(c.arguments), 2, c.said));
  EXPECT_EQ(folder.files(), before);
}

TEST_F(Tour, NeedsTwoCameras) {
  const nlohmann::json one = {test::camera_json("lonely", 0.0)};
  write_text(folder / "cameras.json", one.dump());
  EXPECT_TRUE(ended(tour({"--tour", "walk"}), 2, "there is 1: name a file of more with --cameras"));
  const nlohmann::json two = {test::camera_json("a", 0.0), test::camera_json("b", 0.25)};
  write_text(folder / "cameras.json", two.dump());
  EXPECT_TRUE(ended(tour({"--tour", "walk", "--units-per-metre", "1000"}), 2, "another scale with --units"));
  std::filesystem::remove(folder / "cameras.json");
  const Outcome none = tour({"--tour", "walk"});
  EXPECT_TRUE(ended(none, 2, "--tour: no cameras beside " + model));
  EXPECT_TRUE(says(none, "--cameras, or go around the model with --orbit")) << none.err;
  EXPECT_EQ(folder.files(), (Names{"model.ply"}));
}

}  // namespace
}  // namespace binosplat
